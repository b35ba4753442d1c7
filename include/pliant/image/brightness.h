// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What an image shows at a pixel: its color, and how bright the surface around it is, as a light at the camera makes
// it: the red channel, which blood and vessels absorb least, averaged over a neighborhood, without highlights.
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace pliant {

// The color (R, G, B) of the nearest pixel of an 8-bit image with 1 or 3 (BGR) channels. `pixel` lies in the image.
std::array<std::uint8_t, 3> ColorAt(const cv::Mat& image, const Eigen::Vector2d& pixel);

class LocalBrightness {
 public:
  // `image`: 8-bit, 1 or 3 (BGR) channels; `valid`: CV_8UC1 of its size, 0 = not the surface, or empty.
  LocalBrightness(const cv::Mat& image, const cv::Mat& valid);

  // 0 to 255, interpolated; 0 outside the image and where nothing around is valid.
  double At(const Eigen::Vector2d& pixel) const;

 private:
  cv::Mat brightness_;  // CV_32FC1, smaller than the image by kScale
};

}  // namespace pliant
