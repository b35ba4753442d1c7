// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/sharpness.h"

#include <algorithm>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace pliant {

double Sharpness(const cv::Mat& gray, const cv::Mat& valid) {
  cv::Mat small;
  const cv::Size half(std::max(1, cvRound(0.5 * gray.cols)), std::max(1, cvRound(0.5 * gray.rows)));
  cv::resize(gray, small, half, 0, 0, cv::INTER_AREA);
  cv::Mat laplacian;
  cv::Laplacian(small, laplacian, CV_32F);
  cv::Mat usable;
  if (!valid.empty()) cv::resize(valid, usable, small.size(), 0, 0, cv::INTER_NEAREST);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(laplacian, mean, deviation, usable);
  return deviation[0];
}

}  // namespace pliant
