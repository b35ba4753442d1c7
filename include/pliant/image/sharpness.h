// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How much fine structure an image shows.
#pragma once

#include <opencv2/core/mat.hpp>

namespace pliant {

// The standard deviation of the Laplacian at half the size, where noise counts little, over the usable pixels, in grey
// levels: 0 for one colour; blurring by 3 px takes two thirds of a textured image's away. `grey` is CV_8UC1, `valid` of
// its size, 0 = not usable, or empty.
double Sharpness(const cv::Mat& grey, const cv::Mat& valid);

}  // namespace pliant
