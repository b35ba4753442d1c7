// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Points paired with a depth image.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "pliant/evaluation/surface_error.h"

namespace pliant {

inline PairedFrame PairWithDepth(int frame_idx, std::span<const Eigen::Vector3d> points_in_cam,
                                 std::span<const Eigen::Vector2d> pixels, const Camera& camera, const cv::Mat& depth_mm,
                                 double max_depth_step) {
  std::vector<DepthAtPixel> truth;
  for (const Eigen::Vector2d& pixel : pixels) truth.push_back(LookUpDepth(depth_mm, pixel, max_depth_step));
  return PairWithSurface(frame_idx, points_in_cam, {}, pixels, camera, truth, std::numeric_limits<double>::infinity());
}

}  // namespace pliant
