// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/surface_error.h"

#include <cassert>
#include <optional>
#include <vector>

namespace pliant {

PairedFrame PairWithSurface(int frame_idx, std::span<const Eigen::Vector3d> points_in_cam,
                            std::span<const double> sigmas, std::span<const Eigen::Vector2d> pixels,
                            const Camera& camera, std::span<const DepthAtPixel> truth, double max_sigma_mm) {
  assert(points_in_cam.size() == pixels.size() && truth.size() == pixels.size());
  assert(sigmas.empty() || sigmas.size() == pixels.size());
  const std::vector<std::optional<Eigen::Vector3d>> rays = camera.Unproject(pixels);
  PairedFrame frame;
  frame.frame_idx = frame_idx;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (truth[i].lookup == DepthLookup::kOutsideImage) {
      ++frame.left_out.outside_image;
    } else if (truth[i].lookup == DepthLookup::kNoDepth) {
      ++frame.left_out.no_depth;
    } else if (truth[i].lookup == DepthLookup::kDepthStep) {
      ++frame.left_out.depth_step;
    } else if (!(truth[i].sigma_mm <= max_sigma_mm)) {
      ++frame.left_out.uncertain;
    } else if (!rays[i] || !(rays[i]->z() > 0)) {
      ++frame.left_out.no_ray;
    } else if (!points_in_cam[i].allFinite()) {
      ++frame.left_out.not_finite;
    } else {
      const Eigen::Vector3d ray = *rays[i] / rays[i]->z();
      frame.pairs.push_back(
          {points_in_cam[i], truth[i].depth_mm * ray, ray, truth[i].sigma_mm, sigmas.empty() ? 0.0 : sigmas[i]});
    }
  }
  return frame;
}

}  // namespace pliant
