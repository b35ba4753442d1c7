// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Endomapper, real (Azagra et al., Scientific Data 2023): a procedure's folder Seq_NNN with Seq_NNN.mov, and calibu's
// calibration of the endoscope, *_geometrical.xml and perhaps *_photometrical.xml, in the folder or in
// Calibrations/Endoscope_NN/ beside Sequences/, where Seq_NNN_info.json says the endoscope's number.
#include <cstdio>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "datasets/calibration_files.h"
#include "datasets/formats.h"
#include "datasets/set_files.h"
#include "pliant/base/files.h"
#include "pliant/base/options.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr const char* kGeometry = "_geometrical.xml";

fs::path VideoOf(const fs::path& folder) { return OnlyFile(folder, ".mov"); }
fs::path InfoOf(const fs::path& folder) { return OnlyFile(folder, "_info.json"); }

// The endoscope's number, whether it is written as a number or as text; nothing where it is not known.
std::optional<int> EndoscopeOf(const fs::path& folder) {
  const auto text = ReadFile(InfoOf(folder).string());
  if (!text.ok()) return std::nullopt;
  const auto json = nlohmann::json::parse(*text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object() || !json.contains("endoscope_number")) return std::nullopt;
  const auto& value = json["endoscope_number"];
  if (value.is_number_integer()) return value.get<int>();
  int number = 0;
  if (value.is_string() && ParseInt(value.get<std::string>(), &number)) return number;
  return std::nullopt;
}

// The calibration file with this ending that belongs to a procedure.
fs::path CalibrationOf(const fs::path& folder, const char* suffix) {
  if (fs::path own = OnlyFile(folder, suffix); !own.empty()) return own;
  const auto endoscope = EndoscopeOf(folder);
  if (!endoscope) return {};
  char name[32];
  std::snprintf(name, sizeof name, "Endoscope_%02d", *endoscope);
  std::error_code error;
  const fs::path root = fs::weakly_canonical(folder, error).parent_path().parent_path();
  return OnlyFile(root / "Calibrations" / name, suffix);
}

}  // namespace

bool IsEndomapper(const fs::path& path) {
  return !VideoOf(path).empty() && (!CalibrationOf(path, kGeometry).empty() || !InfoOf(path).empty());
}

std::string EndomapperLacks(const fs::path& path) {
  return VideoOf(path).filename().string().starts_with("Seq_") ? "Seq_NNN_info.json or *_geometrical.xml" : "";
}

Result<DataSet> OpenEndomapper(const SequenceRequest& request) {
  const fs::path& folder = request.image_path;
  auto video = StreamVideo(VideoOf(folder), request.video_index);
  if (!video.ok()) return video.status();
  if (!request.camera_path.empty() || IsFile(folder / "camera.yaml")) return Calibrated(request, *std::move(video));
  const fs::path file = CalibrationOf(folder, kGeometry);
  if (file.empty())
    return Status(ErrorCode::kNotFound, "there is no calibration for " + folder.string() + ": no *" + kGeometry +
                                            " in it, nor in Calibrations/Endoscope_NN of the number that " +
                                            InfoOf(folder).string() + " says; name a calibration file");
  auto calibration = ReadCalibu(file);
  if (!calibration.ok()) return calibration.status();
  if (!calibration->has_value())
    return Status(ErrorCode::kUnreadable,
                  file.string() + " is not a calibration of an endoscope: it has no camera_model");
  if (const fs::path light = CalibrationOf(folder, "_photometrical.xml");
      !light.empty() && !(*calibration)->photometric) {
    const auto photometric = ReadCalibuPhotometry(light);
    if (!photometric.ok()) return photometric.status();
    (*calibration)->photometric = *photometric;
  }
  return Calibrated(request, *std::move(video), **calibration);
}

}  // namespace pliant
