// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Where an image shows more than its noise.
#pragma once

#include <opencv2/core/mat.hpp>

namespace pliant {

// The windows by which images are compared: of images of this width, smoothed there.
struct ComparedWindows {
  int width_px = 0;
  int window_px = 11;
  double smoothing_px = 0;  // standard deviation of the Gaussian
  double noise_levels = 1;  // standard deviation of the smoothed image's noise, as ImageNoise measures it
};

// (V16) CV_8UC1 of the image's size, 255 where the window around a usable pixel has texture in every direction: the
// smaller eigenvalue of its gradient tensor is larger than noise alone would make it, by three standard deviations.
// `image` is 8-bit with 1 or 3 (BGR) channels, `valid` CV_8UC1 of its size, 0 = not usable. It is compared at
// `windows.width_px`, or at its own size where that is smaller.
cv::Mat TexturedPixels(const cv::Mat& image, const cv::Mat& valid, const ComparedWindows& windows);

}  // namespace pliant
