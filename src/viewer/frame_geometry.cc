// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/frame_geometry.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

constexpr double kFrustumOfDepth = 0.15;  // from the camera's center to a corner of its image, of the median depth

}  // namespace

std::optional<std::array<Eigen::Vector3d, 4>> CornerRays(const Camera& camera) {
  const double right = camera.width() - 0.5;
  const double bottom = camera.height() - 0.5;
  const Eigen::Vector2d center(0.5 * (right - 0.5), 0.5 * (bottom - 0.5));
  const Eigen::Vector2d corners[] = {{-0.5, -0.5}, {right, -0.5}, {right, bottom}, {-0.5, bottom}};
  std::array<Eigen::Vector3d, 4> rays;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    std::optional<Eigen::Vector3d> ray;
    for (double share = 1.0; share > 0.1 && !(ray && ray->z() > 0.1); share -= 0.05)
      ray = camera.Unproject(center + share * (corners[i] - center));
    if (!ray || !(ray->z() > 0)) return std::nullopt;
    rays[i] = *ray / ray->z();
  }
  return rays;
}

std::optional<double> MedianDepth(const ViewedFrame& frame) {
  std::vector<double> depths;
  for (const ViewedObservation& o : frame.observations)
    if (o.depth > 0) depths.push_back(o.depth);
  if (depths.empty()) return std::nullopt;
  return Median(std::move(depths));
}

std::optional<std::array<Eigen::Vector3d, 4>> FrustumOf(const ViewedRun& run) {
  auto corners = run.camera ? CornerRays(*run.camera) : std::nullopt;
  if (!corners) return std::nullopt;
  std::vector<double> depths;
  for (const ViewedFrame& frame : run.frames)
    if (const auto depth = MedianDepth(frame)) depths.push_back(*depth);
  double longest = 0;
  for (const Eigen::Vector3d& corner : *corners) longest = std::max(longest, corner.norm());
  const double depth = depths.empty() ? 1.0 : Median(std::move(depths));
  for (Eigen::Vector3d& corner : *corners) corner *= kFrustumOfDepth * depth / longest;
  return corners;
}

}  // namespace pliant
