// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// SCARED (Allan et al., 2021), a keyframe's folder: endoscope_calibration.yaml; data/rgb.mp4, left eye on top of the
// right one; and, unpacked into data/ or a folder of their own there, frame_data*.json with `camera-pose`, camera from
// world, mm, and scene_points*.tiff, every pixel's point in the raw camera, mm, left on top of right.
#include <cmath>
#include <fstream>
#include <utility>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "datasets/formats.h"
#include "datasets/image_file.h"
#include "datasets/json_numbers.h"
#include "datasets/set_files.h"
#include "pliant/base/files.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCalibrationFile = "endoscope_calibration.yaml";
constexpr const char* kVideo = "data/rgb.mp4";
constexpr PairLayout kLayout = PairLayout::kTopBottom;

Result<Rigid3> ReadPose(const fs::path& file) {
  const auto text = ReadFile(file.string());
  if (!text.ok()) return text.status();
  const auto json = nlohmann::json::parse(*text, nullptr, /*allow_exceptions=*/false);
  const std::vector<double> matrix = NumbersAt(json, "camera-pose");
  if (matrix.size() != 16)
    return Status(ErrorCode::kUnreadable, file.string() + " has no camera-pose of 4 x 4 numbers; unpack it again");
  return PoseOfMatrix(file.string(), matrix);
}

// The files of an archive in data/, by number: those that lie in a folder of its name, or in data/ itself. An archive
// that was not unpacked is said.
std::map<int, fs::path> Unpacked(const fs::path& data, const std::string& name, const std::string& suffix,
                                 std::vector<std::string>* warnings) {
  for (const fs::path& folder : {data / name, data})
    if (auto files = NumberedFiles(folder, name, suffix); !files.empty()) return files;
  if (const fs::path archive = data / (name + ".tar.gz"); IsFile(archive))
    warnings->push_back(archive.string() + " is not unpacked; unpack it into " + (data / name).string());
  return {};
}

Status AddPoses(const std::map<int, fs::path>& files, DataSet* data_set) {
  if (files.empty()) return Status::Ok();
  data_set->world_from_cam.resize(static_cast<std::size_t>(files.rbegin()->first) + 1);
  for (const auto& [number, file] : files) {
    const auto cam_from_world = ReadPose(file);
    if (!cam_from_world.ok()) return cam_from_world.status();
    data_set->world_from_cam[static_cast<std::size_t>(number)] = cam_from_world->Inverse() * data_set->raw_from_given;
  }
  return Status::Ok();
}

// The points of the raw image's pixels, as the rectified camera has them.
Result<cv::Mat> ReadScenePoints(const fs::path& file, const ImageWarp& warp, const Rigid3& raw_from_given) {
  const auto stored = ReadStoredImage(file);
  if (!stored.ok()) return stored.status();
  if (stored->type() != CV_32FC3)
    return Status(ErrorCode::kMismatch,
                  file.string() + " does not have three floating-point channels; unpack it again");
  const cv::Mat left = stored->rows == 2 * warp.raw.height ? LeftEye(kLayout, *stored) : *stored;
  if (left.size() != warp.raw)
    return Status(ErrorCode::kMismatch, file.string() + " is " + SizeText(*stored) + ", but the video's images are " +
                                            SizeText(warp.raw.width, warp.raw.height));
  const cv::Mat points = warp.ApplyNearest(left);
  cv::Mat depth_mm(points.size(), CV_32FC1);
  const Eigen::Vector3d axis = raw_from_given.RotationMatrix().col(2);
  for (int v = 0; v < points.rows; ++v)
    for (int u = 0; u < points.cols; ++u) {
      const auto& stored_point = points.at<cv::Vec3f>(v, u);  // OpenCV has the channels turned round: z, y, x
      const double z = axis.dot(Eigen::Vector3d(stored_point[2], stored_point[1], stored_point[0]));
      depth_mm.at<float>(v, u) = std::isfinite(z) && z > 0 ? static_cast<float>(z) : 0.0F;
    }
  return depth_mm;
}

}  // namespace

bool IsScared(const fs::path& path) { return IsFile(path / kCalibrationFile) && IsFile(path / kVideo); }

std::string ScaredLacks(const fs::path& path) {
  if (IsFile(path / kCalibrationFile)) return kVideo;
  return IsFile(path / kVideo) ? kCalibrationFile : "";
}

Result<DataSet> OpenScared(const SequenceRequest& request) {
  const fs::path& folder = request.image_path;
  auto video = StreamVideo(folder / kVideo, request.video_index);
  if (!video.ok()) return video.status();
  const fs::path file = request.camera_path.empty() ? folder / kCalibrationFile : request.camera_path;
  const auto calibration = ReadStereoCalibration(file.string());
  if (!calibration.ok()) return calibration.status();
  if (!calibration->has_value())
    return Status(ErrorCode::kUnreadable, file.string() + " is not a calibration of two cameras");
  auto data_set = RectifiedHalves(**calibration, file, kLayout, *std::move(video));
  if (!data_set.ok()) return data_set.status();
  data_set->mask_path = request.mask_path;
  const fs::path data = folder / "data";
  std::vector<std::string>* warnings = &data_set->warnings;
  if (Status status = AddPoses(Unpacked(data, "frame_data", ".json", warnings), &*data_set); !status.ok())
    return status;
  if (const auto points = Unpacked(data, "scene_points", ".tiff", warnings); !points.empty()) {
    std::vector<fs::path> files(static_cast<std::size_t>(points.rbegin()->first) + 1);
    for (const auto& [number, path] : points) files[static_cast<std::size_t>(number)] = path;
    data_set->depth_files = std::move(files);
    data_set->read_depth = [warp = *data_set->warp, raw_from_given = data_set->raw_from_given](const fs::path& path) {
      return ReadScenePoints(path, warp, raw_from_given);
    };
  }
  return data_set;
}

}  // namespace pliant
