// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The image in which points are tracked: the source's, resized and smoothed. Real images carry noise, compression and
// blur at their finest scale; corners found there do not last, and a patch of a fixed size covers too little of a large
// image and too much of a small one. Pixel (0, 0) is the center of the first pixel in both images.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace pliant {

struct WorkingImage {
  double scale = 1;         // size of the working image by that of the source; > 0
  double smoothing_px = 0;  // standard deviation of a Gaussian, in pixels of the working image; 0: none
  double patch_scale = 1;   // side of the patches that are tracked in it by that of the options; > 0
  bool interlaced = false;  // the source is: its odd rows are of another time, and not used

  bool operator==(const WorkingImage&) const = default;

  // Whether the images are the same.
  bool IsSource() const { return scale == 1 && smoothing_px == 0 && !interlaced; }

  // Of an image of this size, rounded to whole pixels.
  cv::Size SizeOf(const cv::Size& source) const;
  // The same place in both images.
  Eigen::Vector2d ToWorking(const Eigen::Vector2d& source_pixel) const;
  Eigen::Vector2d ToSource(const Eigen::Vector2d& working_pixel) const;

  // Smaller images average the pixels that they cover, larger ones interpolate. The source itself where IsSource.
  cv::Mat Image(const cv::Mat& source) const;
  // Masks and depth images: the nearest pixel, so that no value is made up. Empty stays empty; never smoothed.
  cv::Mat Nearest(const cv::Mat& source) const;

 private:
  cv::Mat Resampled(const cv::Mat& source, int interpolation) const;
};

}  // namespace pliant
