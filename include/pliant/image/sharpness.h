// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How much fine structure an image shows.
#pragma once

#include <opencv2/core/mat.hpp>

namespace pliant {

// The standard deviation of the Laplacian at half the size, where noise counts little, over the usable pixels, in gray
// levels: 0 for one color; blurring by 3 px takes two thirds of a textured image's away. `gray` is CV_8UC1, `valid` of
// its size, 0 = not usable, or empty.
double Sharpness(const cv::Mat& gray, const cv::Mat& valid);

}  // namespace pliant
