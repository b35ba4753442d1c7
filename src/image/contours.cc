// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "pliant/image/corners.h"
#include "pliant/image/pyramid.h"

namespace pliant {
namespace {

constexpr double kDarkOffset = 8;      // gray levels added before the logarithm: noise of dark pixels stays small
constexpr double kMinLogStep = 0.15;   // brightness ratio (natural logarithm) of a step that is no contour yet
constexpr double kWithinWeight = 2.0;  // what lies within a side weighs this much against the step

double Clamped(const cv::Mat& image, const Eigen::Vector2d& p) {
  return *SampleBilinear(image, std::clamp(p.x(), 0.0, image.cols - 1.0), std::clamp(p.y(), 0.0, image.rows - 1.0));
}

}  // namespace

ContourMeasure::ContourMeasure(const cv::Mat& gray, int radius_px) : step_px_(std::max(1, radius_px / 2)) {
  assert(gray.type() == CV_8UC1 && radius_px >= 2);
  cv::Mat log_gray;
  gray.convertTo(log_gray, CV_32F, 1, kDarkOffset);
  cv::log(log_gray, log_gray);
  // Odd; the two sides' windows, at +-step, leave a gap of about a step between them.
  const int side_px = static_cast<int>(step_px_) | 1;
  const cv::Size box(side_px, side_px);
  cv::boxFilter(log_gray, mean_, CV_32F, box, cv::Point(-1, -1), true, cv::BORDER_REPLICATE);
  cv::boxFilter(log_gray.mul(log_gray), mean_square_, CV_32F, box, cv::Point(-1, -1), true, cv::BORDER_REPLICATE);
}

double ContourMeasure::At(const Eigen::Vector2d& pixel) const {
  const auto mean_at = [&](const Eigen::Vector2d& offset) { return Clamped(mean_, pixel + offset); };
  const double step = step_px_;
  const Eigen::Vector2d gradient(mean_at({step, 0}) - mean_at({-step, 0}), mean_at({0, step}) - mean_at({0, -step}));
  const double length = gradient.norm();
  if (length < 1e-6) return 0;
  const Eigen::Vector2d across = gradient / length;
  double within = 0;
  std::array<double, 2> side{};
  for (const int sign : {-1, 1}) {
    const Eigen::Vector2d inner = sign * step * across;
    const double mean_inner = mean_at(inner);
    const double slope = mean_at(sign * 2.0 * step * across) - mean_inner;
    const double variance = Clamped(mean_square_, pixel + inner) - mean_inner * mean_inner;
    side[sign < 0 ? 0 : 1] = mean_inner;
    within += std::max(0.0, variance) + slope * slope;
  }
  const double between = (side[1] - side[0]) * (side[1] - side[0]);
  return between / (between + kWithinWeight * within + kMinLogStep * kMinLogStep);
}

}  // namespace pliant
