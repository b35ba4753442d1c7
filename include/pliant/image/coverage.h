// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How much of the scene that an image shows has a point nearby.
#pragma once

#include <span>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace pliant {

// The share, 0 to 1, of the valid pixels (`valid`: CV_8UC1, 0 = not of the scene) that lie within 1/32 of the image's
// width of one of `pixels`: 40 px in an image that is 1280 px wide. To about 1 % of the image's width. 0 where no pixel
// is valid.
double CoverageOf(const cv::Mat& valid, std::span<const Eigen::Vector2d> pixels);

}  // namespace pliant
