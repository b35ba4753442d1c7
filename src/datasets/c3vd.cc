// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// C3VD (Bobrow et al., Medical Image Analysis 2023), C3VDv2 and C3VD-DEFCOL: a colonoscope in a phantom, or in one that
// deforms. N_color.png and NNNN_depth.tiff, in C3VDv2 in folders rgb/ and depth/, in C3VD-DEFCOL there with
// NNNN_depth.png, 16 bits whose full scale is 100 mm and all beyond; pose.txt, sixteen numbers a line between commas,
// the transpose of world from camera in mm.
#include <vector>

#include "datasets/formats.h"
#include "datasets/image_file.h"
#include "datasets/set_frames.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr double kFullScale_mm = 100.0;
constexpr double kSteps = 65535.0;

// Kannala and Brandt's model of the colonoscope; of the pinhole version half as large.
Result<SourceCalibration> CameraOf(const std::optional<cv::Size>& size) {
  if (size && size->width == 675)
    return PublishedCamera("C3VD", CameraModelId::kPinhole, 675, 540, {401.16, 400.94, 334.14, 273.87});
  return PublishedCamera("C3VD", CameraModelId::kOpenCvFisheye, 1350, 1080,
                         {767.3861511125845, 767.5058656118406, 679.054265997005, 543.646891684636,
                          -0.18867185058223412, -0.003927337093919806, 0.030524814153620117, -0.012756926010904904});
}

Result<std::map<int, Rigid3>> ReadPoses(const fs::path& file) {
  const auto rows = ReadNumberRows(file, 16);
  if (!rows.ok()) return rows.status();
  std::map<int, Rigid3> poses;
  for (std::size_t k = 0; k < rows->size(); ++k) {
    const std::vector<double>& stored = (*rows)[k].numbers;
    std::vector<double> matrix(16);
    for (std::size_t row = 0; row < 4; ++row)
      for (std::size_t col = 0; col < 4; ++col) matrix[4 * row + col] = stored[4 * col + row];
    const auto pose = PoseOfMatrix(PathAndLine(file.string(), (*rows)[k].line), matrix);
    if (!pose.ok()) return pose.status();
    poses.emplace(static_cast<int>(k), *pose);
  }
  return poses;
}

// By number; in the folder are also files of other kinds.
std::map<int, fs::path> DepthsIn(const fs::path& folder) {
  for (const char* suffix : {"_depth.tiff", ".tiff", "_depth.png"})
    if (auto depths = NumberedFiles(folder, "", suffix); !depths.empty()) return depths;
  return {};
}

// The folder of the images: the data set's own, or rgb/ in it.
fs::path ImagesOf(const fs::path& path) {
  for (const fs::path& folder : {path, path / "rgb"})
    if (!NumberedFiles(folder, "", "_color.png").empty()) return folder;
  return IsFolder(path / "rgb") && IsFolder(path / "depth") && IsFile(path / "pose.txt") ? path / "rgb" : fs::path();
}

}  // namespace

bool IsC3vd(const fs::path& path) { return !ImagesOf(path).empty(); }

Result<DataSet> OpenC3vd(const SequenceRequest& request) {
  const fs::path& folder = request.image_path;
  const fs::path images = ImagesOf(folder);
  NumberedSet set{
      .folder = images,
      .images = NumberedFiles(images, "", "_color.png"),
      .depth = DepthsIn(images == folder ? folder : folder / "depth"),
      .read_depth = [](const fs::path& file) { return ReadClampedDepthImage(file, kFullScale_mm / kSteps); }};
  if (set.images.empty()) set.images = NumberedFiles(images, "", ".png");
  if (IsFile(folder / "pose.txt")) {
    auto poses = ReadPoses(folder / "pose.txt");
    if (!poses.ok()) return poses.status();
    set.world_from_cam = *std::move(poses);
  }
  const auto camera =
      CameraOf(set.images.empty() ? std::nullopt : StreamFiles(images, {set.images.begin()->second})->SizeAt(0));
  if (!camera.ok()) return camera.status();
  return OpenNumberedSet(request, std::move(set), *camera);
}

}  // namespace pliant
