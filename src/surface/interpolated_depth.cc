// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/surface/interpolated_depth.h"

#include "surface/sparse_surface.h"

namespace pliant {

std::optional<cv::Mat> InterpolatedDepth(const Camera& camera, const Rigid3& cam_from_world,
                                         const std::vector<PointObservation>& observations) {
  const auto surface = FitSparseSurface({{}, {}, cam_from_world, observations}, camera);
  if (!surface) return std::nullopt;
  cv::Mat depth = surface->inverse_distance.ToImage({camera.width(), camera.height()}, 1.0);
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x) {
      float& value = depth.at<float>(y, x);
      const auto ray = camera.Unproject({x, y});
      value = ray && value > 0.0F ? static_cast<float>(ray->z() / value) : 0.0F;
    }
  return depth;
}

}  // namespace pliant
