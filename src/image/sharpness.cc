// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/sharpness.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace pliant {

double Sharpness(const cv::Mat& gray, const cv::Mat& valid) {
  cv::Mat small;
  cv::resize(gray, small, cv::Size(), 0.5, 0.5, cv::INTER_AREA);
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
