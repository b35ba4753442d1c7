// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Endomapper, real (Azagra et al., Scientific Data 2023): a procedure's folder Seq_NNN with Seq_NNN.mov, and calibu's
// calibration of the endoscope, *_geometrical.xml, in the folder or in Calibrations/Endoscope_NN/ beside Sequences/,
// where Seq_NNN_info.json says the endoscope's number.
#include <cstdio>
#include <regex>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "datasets/formats.h"
#include "datasets/set_files.h"
#include "pliant/base/options.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr const char* kGeometry = "_geometrical.xml";

fs::path VideoOf(const fs::path& folder) { return OnlyFile(folder, ".mov"); }

// The endoscope's number, whether it is written as a number or as text; nothing where it is not known.
std::optional<int> EndoscopeOf(const fs::path& folder) {
  const auto text = ReadFile(OnlyFile(folder, "_info.json").string());
  if (!text.ok()) return std::nullopt;
  const auto json = nlohmann::json::parse(*text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object() || !json.contains("endoscope_number")) return std::nullopt;
  const auto& value = json["endoscope_number"];
  if (value.is_number_integer()) return value.get<int>();
  double number = 0;
  if (value.is_string() && ParseDouble(value.get<std::string>(), &number)) return static_cast<int>(number);
  return std::nullopt;
}

fs::path GeometryOf(const fs::path& folder) {
  if (fs::path own = OnlyFile(folder, kGeometry); !own.empty()) return own;
  const auto endoscope = EndoscopeOf(folder);
  if (!endoscope) return {};
  char name[32];
  std::snprintf(name, sizeof name, "Endoscope_%02d", *endoscope);
  std::error_code error;
  const fs::path root = fs::weakly_canonical(folder, error).parent_path().parent_path();
  return OnlyFile(root / "Calibrations" / name, kGeometry);
}

std::string Between(const std::string& text, const std::string& tag) {
  const std::size_t begin = text.find("<" + tag + ">");
  const std::size_t end = text.find("</" + tag + ">");
  if (begin == std::string::npos || end == std::string::npos || end < begin) return {};
  return text.substr(begin + tag.size() + 2, end - begin - tag.size() - 2);
}

std::vector<double> NumbersIn(const std::string& text) {
  static const std::regex kNumber(R"([-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?)");
  std::vector<double> numbers;
  for (std::sregex_iterator it(text.begin(), text.end(), kNumber); it != std::sregex_iterator(); ++it)
    if (double value = 0; ParseDouble(it->str().front() == '+' ? it->str().substr(1) : it->str(), &value))
      numbers.push_back(value);
  return numbers;
}

// Calibu's <camera_model type=...> with <width>, <height>, <params> [ fu; fv; u0; v0; ... ].
Result<SourceCalibration> ReadCalibu(const fs::path& file) {
  const auto text = ReadFile(file.string());
  if (!text.ok()) return text.status();
  static const std::regex kType(R"re(<camera_model[^>]*\btype\s*=\s*"([^"]*)")re");
  std::smatch type;
  const std::vector<double> width = NumbersIn(Between(*text, "width"));
  const std::vector<double> height = NumbersIn(Between(*text, "height"));
  const std::vector<double> params = NumbersIn(Between(*text, "params"));
  if (!std::regex_search(*text, type, kType) || width.size() != 1 || height.size() != 1)
    return Status(
        ErrorCode::kUnreadable,
        file.string() + " is not a calibration of calibu: it has no camera_model with type, width and height");
  CameraModelId model = CameraModelId::kOpenCvFisheye;
  if (type[1] == "calibu_fu_fv_u0_v0")
    model = CameraModelId::kPinhole;
  else if (type[1] != "calibu_fu_fv_u0_v0_kb4")
    return Status(ErrorCode::kInvalidArgument, file.string() + " has a camera of the type " + Quoted(type[1].str()) +
                                                   ", which is not known; calibu_fu_fv_u0_v0_kb4 is");
  auto camera = Camera::Create(model, static_cast<int>(width[0]), static_cast<int>(height[0]), params);
  if (!camera.ok()) return Status(camera.status().code(), file.string() + ": " + camera.status().message());
  return SourceCalibration{*std::move(camera), file};
}

}  // namespace

bool IsEndomapper(const fs::path& path) {
  return !VideoOf(path).empty() && (!GeometryOf(path).empty() || !OnlyFile(path, "_info.json").empty());
}

Result<DataSet> OpenEndomapper(const SequenceRequest& request) {
  auto video = StreamVideo(VideoOf(request.image_path));
  if (!video.ok()) return video.status();
  const fs::path geometry = GeometryOf(request.image_path);
  if (geometry.empty() || !request.camera_path.empty()) return Calibrated(request, *std::move(video));
  const auto calibration = ReadCalibu(geometry);
  if (!calibration.ok()) return calibration.status();
  return Calibrated(request, *std::move(video), *calibration);
}

}  // namespace pliant
