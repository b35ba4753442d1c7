// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How bright the surface around a pixel is, as a light at the camera makes it: the red channel, which blood and vessels
// absorb least, averaged over a neighborhood, without highlights.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace pliant {

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
