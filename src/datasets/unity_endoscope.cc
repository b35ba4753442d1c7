// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Endoscopes rendered by VR-Caps in Unity. Endomapper's simulated sequences (Azagra et al., Scientific Data 2023):
// rgb/image_NNNN.png, depth/aov_image_NNNN.exr, trajectory.csv in dm. EndoSLAM's UnityCam (Ozyoruk et al., Medical
// Image Analysis 2021): Frames/image_NNNN.png, "Pixelwise Depths/aov_image_NNNN.png" in cm, a table of poses in m.
// Poses are tX tY tZ rX rY rZ rW time, a line a frame, in Unity's left-handed world.
#include <limits>
#include <vector>

#include <opencv2/core.hpp>

#include "datasets/formats.h"
#include "datasets/image_file.h"
#include "datasets/set_files.h"
#include "datasets/set_frames.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// A line an image, whatever number the first image has.
Status AddPoses(const fs::path& file, double unit_mm, NumberedSet* set) {
  const auto rows = ReadNumberRows(file, 7);
  if (!rows.ok()) return rows.status();
  int number = set->images.empty() ? 0 : set->images.begin()->first;
  for (const NumberRow& row : *rows) {
    auto pose = PoseOfRow(file, row, {.tx = 0, .qx = 3, .qw = 6});
    if (!pose.ok()) return pose.status();
    pose->translation *= unit_mm;
    set->world_from_cam.emplace(number++, FromUnity(*pose));
  }
  return Status::Ok();
}

// The first of three or four channels as they are stored: red, which OpenCV has last.
cv::Mat RedOf(const cv::Mat& stored) {
  if (stored.channels() == 1) return stored;
  cv::Mat red;
  cv::extractChannel(stored, red, 2);
  return red;
}

// The depth buffer runs from 1 at the near plane to 0 at the far one: 1 / z = 0.25 + 99.75 d, z in dm.
Result<cv::Mat> ReadReversedDepth(const fs::path& file) {
  const auto stored = ReadStoredImage(file);
  if (!stored.ok()) return stored.status();
  if (stored->depth() != CV_32F)
    return Status(ErrorCode::kMismatch, "the depth image " + file.string() + " has no floating-point channel");
  constexpr float kFar = 0.25F;
  constexpr float kRange = 99.75F;
  constexpr float kDecimeter_mm = 100.0F;
  const cv::Mat buffer = RedOf(*stored);
  cv::Mat depth_mm(buffer.size(), CV_32FC1);
  for (int v = 0; v < buffer.rows; ++v)
    for (int u = 0; u < buffer.cols; ++u) {
      const float d = buffer.at<float>(v, u);
      depth_mm.at<float>(v, u) = d > 0 && d <= 1 ? kDecimeter_mm / (kFar + kRange * d) : 0.0F;
    }
  return depth_mm;
}

Result<cv::Mat> ReadCentimeters(const fs::path& file) {
  const auto stored = ReadStoredImage(file);
  if (!stored.ok()) return stored.status();
  cv::Mat depth_mm;
  RedOf(*stored).convertTo(depth_mm, CV_32F, 10.0);
  return depth_mm;
}

constexpr const char* kPixelwise = "Pixelwise Depths";

fs::path EndoSlamPoses(const fs::path& folder) {
  for (const fs::path& where : {folder / "Poses", folder})
    if (fs::path file = OnlyFile(where, ".csv"); !file.empty()) return file;
  return {};
}

}  // namespace

bool IsEndomapperSimulated(const fs::path& path) { return !NumberedFiles(path / "rgb", "image_", ".png").empty(); }

Result<DataSet> OpenEndomapperSimulated(const SequenceRequest& request) {
  constexpr double kDecimeter_mm = 100.0;
  const fs::path& folder = request.image_path;
  NumberedSet set{.folder = folder / "rgb",
                  .images = NumberedFiles(folder / "rgb", "image_", ".png"),
                  .depth = NumberedFiles(folder / "depth", "aov_image_", ".exr"),
                  .read_depth = ReadReversedDepth};
  if (const fs::path file = folder / "trajectory.csv"; IsFile(file))
    if (Status status = AddPoses(file, kDecimeter_mm, &set); !status.ok()) return status;
  const auto camera =
      PublishedCamera("Endomapper", CameraModelId::kPinhole, 960, 720, {472.6496, 472.6496, 479.5, 359.5});
  if (!camera.ok()) return camera.status();
  return OpenNumberedSet(request, std::move(set), *camera);
}

bool IsEndoSlam(const fs::path& path) { return IsFolder(path / "Frames") && IsFolder(path / kPixelwise); }

Result<DataSet> OpenEndoSlam(const SequenceRequest& request) {
  const fs::path& folder = request.image_path;
  NumberedSet set{.folder = folder / "Frames",
                  .images = NumberedFiles(folder / "Frames", "image_", ".png"),
                  .depth = NumberedFiles(folder / kPixelwise, "aov_image_", ".png"),
                  .read_depth = ReadCentimeters};
  if (set.images.empty()) set.images = NumberedFiles(folder / "Frames", "image_", ".jpg");
  if (const fs::path file = EndoSlamPoses(folder); !file.empty())
    if (Status status = AddPoses(file, kMeter_mm, &set); !status.ok()) return status;
  const auto camera =
      PublishedCamera("EndoSLAM", CameraModelId::kPinhole, 320, 320, {156.0418, 155.7529, 178.5604, 181.8043});
  if (!camera.ok()) return camera.status();
  auto data_set = OpenNumberedSet(request, std::move(set), *camera);
  if (data_set.ok() && EndoSlamPoses(folder).empty() && IsFolder(folder / "Poses"))
    data_set->warnings.push_back("no poses are read: " + (folder / "Poses").string() + " holds not exactly one .csv");
  return data_set;
}

}  // namespace pliant
