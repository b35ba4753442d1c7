// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/surface_folder.h"

#include <cstdint>
#include <limits>
#include <set>
#include <system_error>

#include <nlohmann/json.hpp>

#include "datasets/image_file.h"
#include "pliant/base/files.h"
#include "pliant/base/text.h"
#include "pliant/datasets/native_layout.h"
#include "pliant/io/camera_file.h"
#include "pliant/io/run_reader.h"

namespace pliant {
namespace {

// What pliant surface writes, with room for other programs.
constexpr int kMostWindow_px = 255;
constexpr double kMostSmoothing_px = 100;
constexpr double kMostNoise_levels = 255;

bool AreRight(const ComparedWindows& windows) {
  const auto within = [](double value, double most) { return value >= 0 && value <= most; };
  return windows.width_px > 0 && windows.window_px > 0 && windows.window_px <= kMostWindow_px &&
         within(windows.smoothing_px, kMostSmoothing_px) && within(windows.noise_levels, kMostNoise_levels);
}

// It names a file in the folders of the surface, and no other.
bool IsFileName(const std::string& name) { return !name.empty() && std::filesystem::path(name).filename() == name; }

std::string StemOf(const std::string& image_name) { return std::filesystem::path(image_name).stem().string(); }

// Throws as JSON's readers do where it is no frame's number.
int FrameNumber(const nlohmann::json& json) {
  if (!json.is_number_integer() || json.get<std::int64_t>() < 0 ||
      json.get<std::int64_t>() > std::numeric_limits<int>::max())
    throw nlohmann::json::type_error::create(302, "no frame's number", &json);
  return json.get<int>();
}

// Without its file. Throws likewise.
SurfaceFolder::Frame FrameOf(const nlohmann::json& json) {
  SurfaceFolder::Frame frame{FrameNumber(json.at("frame")), {}, {}, json.value("pair", false)};
  for (const auto& neighbor : json.value("neighbors", nlohmann::json::array()))
    frame.neighbors.push_back(FrameNumber(neighbor));
  return frame;
}

// The file that two of the frames have; empty: each has its own.
std::string SharedFileName(const std::vector<SurfaceFolder::Frame>& frames) {
  std::set<std::string> names;
  for (const SurfaceFolder::Frame& frame : frames)
    if (!names.insert(frame.file_name).second) return frame.file_name;
  return {};
}

}  // namespace

SurfaceFileNames::SurfaceFileNames(const std::map<int, std::string>& images) : images_(images) {
  for (const auto& [frame_idx, name] : images) ++images_of_stem_[StemOf(name)];
}

std::string SurfaceFileNames::Of(int frame_idx) const {
  std::string number = native::FrameFileName(frame_idx);
  const auto image = images_.find(frame_idx);
  if (image == images_.end()) return number;
  std::string stem = StemOf(image->second);
  if (images_of_stem_.at(stem) > 1)  // stems with different numbers at their ends differ
    while (images_of_stem_.contains(stem)) stem += "_" + StemOf(number);
  return stem + ".png";
}

Result<SurfaceFolder> ReadSurfaceFolder(const std::filesystem::path& path) {
  const std::string summary = (path / surface::kSummaryFile).string();
  if (!Exists(summary))
    return Status(ErrorCode::kNotFound, "there is no surface at " + Quoted(path.string()) +
                                            " (no surface.json); give a folder that pliant surface left");
  const auto camera = ReadCameraFile((path / native::kCameraFile).string());
  if (!camera.ok()) return camera.status();
  const auto text = ReadFile(summary);
  if (!text.ok()) return text.status();
  SurfaceFolder folder{path, {}, camera->camera, camera->depth_scale.value_or(1.0), {}, {}, {}};
  try {
    const auto json = nlohmann::json::parse(*text);
    if (json.at("status") == "interrupted" && !json.contains("frames"))
      return Status(ErrorCode::kUnreadable,
                    Quoted(summary) + " says that the surface was never finished; make it again");
    folder.run = json.value("run", "");
    folder.trajectory_checksum = json.value("trajectory_crc32", "");
    std::set<int> known;
    for (const auto& entry : json.at("frames")) {
      SurfaceFolder::Frame frame = FrameOf(entry);
      if (!known.insert(frame.frame_idx).second)
        return Status(ErrorCode::kUnreadable,
                      Quoted(summary) + " has frame " + std::to_string(frame.frame_idx) + " more than once");
      if (!entry.at("note").get<std::string>().empty()) {
        folder.frames_without_depth.push_back(std::move(frame));
        continue;
      }
      frame.file_name = entry.at("name").get<std::string>();
      if (!IsFileName(frame.file_name))
        return Status(ErrorCode::kUnreadable,
                      Quoted(summary) + " names a frame " + Quoted(frame.file_name) + ", which is not a file's name");
      folder.frames.push_back(std::move(frame));
    }
    if (const std::string shared = SharedFileName(folder.frames); !shared.empty())
      return Status(ErrorCode::kUnreadable, Quoted(summary) + " gives two frames one file, " + Quoted(shared) +
                                                ", which holds the depth of one of them; make the surface again with "
                                                "pliant surface");
    if (json.contains("windows")) {
      const auto& windows = json.at("windows");
      folder.windows = {windows.at("image_width").get<int>(), windows.at("side").get<int>(),
                        windows.at("smoothing_px").get<double>(), windows.at("noise_levels").get<double>()};
      if (!AreRight(*folder.windows))
        return Status(ErrorCode::kUnreadable,
                      Quoted(summary) + " says of the windows that were compared what cannot be");
    }
  } catch (const nlohmann::json::exception&) {
    return Status(ErrorCode::kUnreadable, Quoted(summary) +
                                              " is not a surface's surface.json: an entry is missing, or of another "
                                              "kind; make the surface again with pliant surface");
  }
  return folder;
}

Status CheckSurfaceOfRun(const SurfaceFolder& surface, const std::string& run_path) {
  const std::string made_of = surface.run.string();
  const bool is_there = Exists(made_of);
  std::error_code error;
  const bool is_folder = std::filesystem::equivalent(made_of, run_path, error);
  const auto checksum = TrajectoryChecksum(run_path);
  if (!checksum.ok()) return Status::Ok();  // the run cannot be read, which its readers say
  if (surface.trajectory_checksum.empty()) {
    if (!is_there || is_folder) return Status::Ok();
    const auto of_surface = TrajectoryChecksum(made_of);
    if (of_surface.ok() && *of_surface == *checksum) return Status::Ok();
  } else if (surface.trajectory_checksum == *checksum) {
    return Status::Ok();
  }
  const std::string what = "the surface " + Quoted(surface.path.string()) + " was made of ";
  if (is_folder)
    return {ErrorCode::kMismatch, what + "an earlier run in " + Quoted(run_path) +
                                      ", which was replaced or continued since; make it again with pliant surface"};
  return {ErrorCode::kMismatch,
          what + "the run " + Quoted(made_of) + ", not of " + Quoted(run_path) + "; make one with pliant surface"};
}

Result<SurfaceDepth> ReadSurfaceDepth(const SurfaceFolder& folder, const SurfaceFolder::Frame& frame) {
  SurfaceDepth result;
  const auto read = [&](const char* kind, double unit, cv::Mat* image) -> Status {
    const std::filesystem::path path = folder.path / kind / frame.file_name;
    auto depth = ReadDepthImage(path, unit);
    if (!depth.ok()) return depth.status();
    if (depth->cols != folder.camera.width() || depth->rows != folder.camera.height())
      return {ErrorCode::kMismatch, path.string() + " has not the size of the surface's camera.yaml"};
    *image = *std::move(depth);
    return Status::Ok();
  };
  if (Status status = read(native::kDepthFolder, folder.depth_scale, &result.depth); !status.ok()) return status;
  if (Status status = read(surface::kConfidenceFolder, surface::kConfidenceUnit, &result.sigma); !status.ok())
    return status;
  const std::filesystem::path filled = folder.path / surface::kFilledFolder / frame.file_name;
  if (!Exists(filled.string())) return result;
  auto mask = ReadMaskImage(filled);
  if (!mask.ok()) return mask.status();
  if (mask->size() != result.depth.size())
    return Status(ErrorCode::kMismatch, filled.string() + " has not the size of the surface's camera.yaml");
  result.filled = *std::move(mask);
  return result;
}

void SurfaceDepth::KeepMeasured() {
  if (filled.empty()) return;
  depth.setTo(0.0F, filled);
  sigma.setTo(0.0F, filled);
  filled.release();
}

Result<PlyVertices> ReadSurfaceVertices(const SurfaceFolder& folder, const SurfaceFolder::Frame& frame) {
  const std::filesystem::path path =
      folder.path / surface::kMeshFolder / std::filesystem::path(frame.file_name).replace_extension(".ply");
  if (!Exists(path.string())) return PlyVertices();
  return ReadPlyVertices(path.string());
}

}  // namespace pliant
