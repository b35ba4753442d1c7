// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/set_frames.h"

#include <utility>

#include "datasets/image_list.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

std::vector<int> NumbersOf(const std::map<int, fs::path>& files) {
  std::vector<int> numbers;
  for (const auto& [number, file] : files) numbers.push_back(number);
  return numbers;
}

}  // namespace

Result<DataSet> OpenNumberedSet(const SequenceRequest& request, NumberedSet set,
                                const std::optional<SourceCalibration>& published) {
  if (set.images.empty())
    return Status(ErrorCode::kNotFound, "the folder " + set.folder.string() + " holds no image; check the path");
  const std::vector<int> numbers = NumbersOf(set.images);
  std::vector<fs::path> images;
  for (const int number : numbers) images.push_back(set.images.at(number));
  Result<DataSet> data_set = Calibrated(request, StreamFiles(set.folder, std::move(images)), published);
  if (!data_set.ok()) return data_set.status();
  WarnOfGaps(numbers, set.folder, &data_set->warnings);
  if (!set.right.empty() && !data_set->calibration.baseline_mm)
    data_set->warnings.push_back("the right images in " + set.right.begin()->second.parent_path().string() +
                                 " are not read: " + data_set->calibration.path.string() + " says no baseline" +
                                 set.baseline_hint);
  if (!set.right.empty() && data_set->calibration.baseline_mm) {
    std::vector<fs::path> right;
    for (const int number : numbers) {
      if (!set.right.contains(number))
        return Status(ErrorCode::kNotFound, "there is no right image for " + set.images.at(number).string() +
                                                "; add it, or take the right images away");
      right.push_back(set.right.at(number));
    }
    data_set->right = StreamFiles(set.right.begin()->second.parent_path(), std::move(right));
  }
  if (!set.depth.empty()) {
    for (const int number : numbers)
      data_set->depth_files.push_back(set.depth.contains(number) ? set.depth.at(number) : fs::path());
    data_set->read_depth = std::move(set.read_depth);
  }
  if (!set.world_from_cam.empty())
    for (const int number : numbers) {
      const auto pose = set.world_from_cam.find(number);
      data_set->world_from_cam.push_back(pose == set.world_from_cam.end() ? std::nullopt : std::optional(pose->second));
    }
  return data_set;
}

Result<SourceCalibration> PublishedCamera(const std::string& data_set, CameraModelId model, int width, int height,
                                          const std::vector<double>& params, double fps) {
  auto camera = Camera::Create(model, width, height, params);
  if (!camera.ok()) return camera.status();
  return SourceCalibration{*std::move(camera), "published with " + data_set, fps};
}

}  // namespace pliant
