// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/depth_lookup.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace pliant {

DepthAtPixel LookUpDepth(const cv::Mat& depth_mm, const Eigen::Vector2d& pixel, double max_depth_step) {
  assert(depth_mm.type() == CV_32FC1);
  if (!(pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() <= depth_mm.cols - 1 && pixel.y() <= depth_mm.rows - 1))
    return {DepthLookup::kOutsideImage, 0};
  const int x0 = static_cast<int>(pixel.x());
  const int y0 = static_cast<int>(pixel.y());
  const double fx = pixel.x() - x0;
  const double fy = pixel.y() - y0;
  double smallest = std::numeric_limits<double>::infinity();
  double largest = 0;
  double depth = 0;
  for (int dy = 0; dy <= 1; ++dy) {
    for (int dx = 0; dx <= 1; ++dx) {
      const double weight = (dx == 1 ? fx : 1 - fx) * (dy == 1 ? fy : 1 - fy);
      if (weight == 0) continue;  // also keeps the last row and column inside
      const double z = depth_mm.at<float>(y0 + dy, x0 + dx);
      if (!(z > 0 && std::isfinite(z))) return {DepthLookup::kNoDepth, 0};
      smallest = std::min(smallest, z);
      largest = std::max(largest, z);
      depth += weight * z;
    }
  }
  if (largest - smallest > max_depth_step * smallest) return {DepthLookup::kDepthStep, 0};
  return {DepthLookup::kOk, depth};
}

std::vector<double> KnownDepths(const cv::Mat& depth_mm) {
  std::vector<double> depths;
  for (int v = 0; v < depth_mm.rows; ++v)
    for (int u = 0; u < depth_mm.cols; ++u)
      if (const float depth = depth_mm.at<float>(v, u); depth > 0) depths.push_back(depth);
  return depths;
}

}  // namespace pliant
