// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// An image made ready for the tracker: everything that depends on the image alone, so that it can be done ahead on
// another thread.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pliant/image/masks.h"
#include "pliant/image/pyramid.h"
#include "pliant/tracking/tracker_options.h"

namespace pliant {

// A point whose depth is known before it is tracked.
struct PixelDepth {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double depth = 0;  // z along the optical axis, in its source's unit, > 0
};

struct PreparedFrame {
  int frame_idx = 0;  // the sequence's own number
  int step = 0;       // the same by TrackerOptions::frame_stride: that of the next frame is one more
  std::string name;
  double timestamp_s = 0;
  cv::Mat image;  // 8-bit, 1 or 3 (BGR) channels
  cv::Mat gray;   // CV_8UC1
  ImagePyramid pyramid;
  SupportMask mask;
  // Gives CV_32FC1 or, where it is not known, nothing; asked when the frame becomes a reference, while it is processed.
  std::function<cv::Mat()> known_depth_mm;
  // CV_32FC1 of any size, over the whole image, or empty: up to scale and shift; 0 or less and NaN = none.
  cv::Mat depth_prior;
  // Instead of corners, the best first; only a start from a model or a pair uses them, when it takes a reference.
  std::function<std::vector<PixelDepth>()> known_points;
  double sharpness = 0;   // of the image, gray levels
  double prepare_ms = 0;  // wall time of PrepareFrame
};

// `image` has the camera's size; `mask` is empty or CV_8UC1 of that size, 0 = ignore.
PreparedFrame PrepareFrame(int frame_idx, std::string name, double timestamp_s, const cv::Mat& image,
                           const cv::Mat& mask, const TrackerOptions& options);

}  // namespace pliant
