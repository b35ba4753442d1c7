// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Points found in both images of rectified pairs, wherever they are: what their rows and disparities say.
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/camera/camera.h"
#include "pliant/datasets/check_sequence.h"

namespace pliant {

class StereoChecker {
 public:
  // `depth_mm` may be empty.
  void Add(const cv::Mat& left, const cv::Mat& right, const cv::Mat& depth_mm, const Camera& camera,
           double baseline_mm);

  std::size_t count() const { return row_errors_px_.size(); }
  // Of at least one match.
  StereoCheck Check() const;

 private:
  std::vector<double> row_errors_px_;
  std::size_t right_way_ = 0;
  std::vector<double> depth_ratios_;
};

}  // namespace pliant
