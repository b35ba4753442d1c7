// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/model_start.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>

#include "pliant/base/text.h"
#include "pliant/colmap/check.h"
#include "pliant/colmap/convert.h"
#include "pliant/colmap/model.h"

namespace pliant {
namespace {

std::string StemOf(const std::string& image_name) { return std::filesystem::path(image_name).stem().string(); }

Result<std::vector<PixelDepth>> PointsOf(const colmap::Image& image, const colmap::PointsById& points) {
  const auto cam_from_world = colmap::ToPliant(image.cam_from_world);
  if (!cam_from_world.ok()) return cam_from_world.status();
  std::vector<std::pair<const colmap::Point3D*, PixelDepth>> seen;
  for (const colmap::Point2D& keypoint : image.points2D) {
    if (keypoint.point3D_id == colmap::kNoPoint3D) continue;
    const colmap::Point3D* point = points.at(keypoint.point3D_id);
    const double depth = (*cam_from_world * colmap::ToPliant(*point)).z();
    if (depth > 0) seen.push_back({point, {colmap::ToPliant(keypoint), depth}});
  }
  std::stable_sort(seen.begin(), seen.end(),
                   [](const auto& a, const auto& b) { return a.first->track.size() > b.first->track.size(); });
  std::vector<PixelDepth> sorted;
  for (const auto& entry : seen) sorted.push_back(entry.second);
  return sorted;
}

}  // namespace

Result<ModelStart> ModelStart::Open(const std::string& folder, const Camera& camera) {
  if (folder.empty())
    return Status(ErrorCode::kInvalidArgument,
                  "a start from a COLMAP model needs its folder; name it with --Init.model_path");
  const auto model = colmap::ReadValidModel(folder);
  if (!model.ok()) return model.status();
  for (const colmap::Camera& own : model->cameras)
    if (own.width != static_cast<std::uint64_t>(camera.width()) ||
        own.height != static_cast<std::uint64_t>(camera.height()))
      return Status(ErrorCode::kMismatch, "the model " + Quoted(folder) + " was made on images of " +
                                              std::to_string(own.width) + "x" + std::to_string(own.height) +
                                              ", and the sequence has " + std::to_string(camera.width()) + "x" +
                                              std::to_string(camera.height()));
  const colmap::PointsById points = colmap::ById(model->points3D);
  ModelStart start;
  for (const colmap::Image& image : model->images) {
    auto of_image = PointsOf(image, points);
    if (!of_image.ok()) return of_image.status();
    start.points_.emplace(image.name, *std::move(of_image));
    start.names_of_stem_[StemOf(image.name)].push_back(image.name);
  }
  return start;
}

std::vector<PixelDepth> ModelStart::PointsIn(const std::string& image_name) const {
  if (const auto found = points_.find(image_name); found != points_.end()) return found->second;
  const auto names = names_of_stem_.find(StemOf(image_name));
  const bool is_one = names != names_of_stem_.end() && names->second.size() == 1;
  return is_one ? points_.at(names->second.front()) : std::vector<PixelDepth>();
}

}  // namespace pliant
