// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/surface_error.h"

#include <cassert>
#include <optional>
#include <vector>

#include "pliant/image/depth_lookup.h"

namespace pliant {

PairedFrame PairWithSurface(int frame_idx, std::span<const Eigen::Vector3d> points_in_cam,
                            std::span<const Eigen::Vector2d> pixels, const Camera& camera, const cv::Mat& depth_mm,
                            double max_depth_step) {
  assert(points_in_cam.size() == pixels.size());
  const std::vector<std::optional<Eigen::Vector3d>> rays = camera.Unproject(pixels);
  PairedFrame frame;
  frame.frame_idx = frame_idx;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const DepthAtPixel truth = LookUpDepth(depth_mm, pixels[i], max_depth_step);
    if (truth.lookup == DepthLookup::kOutsideImage) {
      ++frame.left_out.outside_image;
    } else if (truth.lookup == DepthLookup::kNoDepth) {
      ++frame.left_out.no_depth;
    } else if (truth.lookup == DepthLookup::kDepthStep) {
      ++frame.left_out.depth_step;
    } else if (!rays[i] || !(rays[i]->z() > 0)) {
      ++frame.left_out.no_ray;
    } else if (!points_in_cam[i].allFinite()) {
      ++frame.left_out.not_finite;
    } else {
      const Eigen::Vector3d ray = *rays[i] / rays[i]->z();
      frame.pairs.push_back({points_in_cam[i], truth.depth_mm * ray, ray});
    }
  }
  return frame;
}

}  // namespace pliant
