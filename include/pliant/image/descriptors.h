// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What an image looks like around a pixel, in numbers that change little with brightness, contrast and small changes of
// the view: SIFT's histograms of gradients (Lowe, IJCV 2004, as OpenCV computes them), upright and of one size. They
// tell points apart that a patch tracker cannot find because nothing is known of where they are.
// Pixels: (0, 0) is the center of the first pixel.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace pliant {

// One row a pixel, CV_32FC1 of 128 columns. `gray` is CV_8UC1; a pixel near the edge or outside of it sees the edge
// repeated.
cv::Mat DescribePixels(const cv::Mat& gray, std::span<const Eigen::Vector2d> pixels);

// Rows (of a, of b) that are each other's nearest, and nearer than `max_ratio` (0 to 1) times the second nearest in
// `b`; in the order of `a`.
std::vector<std::pair<int, int>> MatchDescriptors(const cv::Mat& a, const cv::Mat& b, double max_ratio);

}  // namespace pliant
