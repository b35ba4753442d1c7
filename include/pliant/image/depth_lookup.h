// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The depth at a pixel: interpolated, because a rounded pixel costs half a pixel times the gradient of the depth, and
// never across a depth step or next to a hole.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace pliant {

enum class DepthLookup { kOk, kOutsideImage, kNoDepth, kDepthStep };

struct DepthAtPixel {
  DepthLookup lookup = DepthLookup::kOutsideImage;
  double depth_mm = 0;
  double sigma_mm = 0;  // standard deviation of the depth, where its source knows it
};

// `depth_mm`: CV_32FC1, 0 = none; a pixel with a neighbor of no depth has none. kDepthStep where the four pixels
// around differ by more than max_depth_step times the smallest.
DepthAtPixel LookUpDepth(const cv::Mat& depth_mm, const Eigen::Vector2d& pixel, double max_depth_step);

// Those of `depth_mm` (CV_32FC1) that are known (above 0), mm, row by row.
std::vector<double> KnownDepths(const cv::Mat& depth_mm);

}  // namespace pliant
