// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>

#include <opencv2/core.hpp>

#include "pliant/image/corners.h"

namespace pliant {
namespace {

constexpr double kDarkOffset = 8;      // gray levels added before the logarithm: noise of dark pixels stays small
constexpr double kMinLogStep = 0.15;   // brightness ratio (natural logarithm) of a step that is no contour yet
constexpr double kWithinWeight = 2.0;  // what lies within a side weighs this much against the step

// Natural logarithms of the 256 gray levels.
std::array<float, 256> LogLevels() {
  std::array<float, 256> logs;
  for (std::size_t level = 0; level < logs.size(); ++level)
    logs[level] = static_cast<float>(std::log(static_cast<double>(level) + kDarkOffset));
  return logs;
}

}  // namespace

ContourMeasure::ContourMeasure(const cv::Mat& gray, int radius_px) : gray_(gray), step_px_(std::max(1, radius_px / 2)) {
  assert(gray.type() == CV_8UC1 && radius_px >= 2);
}

// The window has 2 * half + 1 pixels a side, and its center lies between pixels: one row and one column more, of which
// the outer ones count in part.
ContourMeasure::Moments ContourMeasure::Around(const Eigen::Vector2d& pixel) const {
  static const std::array<float, 256> log_levels = LogLevels();
  const int half = step_px_ / 2;  // the two sides' windows, at +-step, leave a gap of about a step between them
  const double x = std::clamp(pixel.x(), 0.0, gray_.cols - 1.0);
  const double y = std::clamp(pixel.y(), 0.0, gray_.rows - 1.0);
  const int left = static_cast<int>(x) - half;
  const int top = static_cast<int>(y) - half;
  const int side = 2 * half + 1;
  const auto share = [&](int k, double fraction) { return k == 0 ? 1 - fraction : k == side ? fraction : 1.0; };
  Moments sums;
  for (int i = 0; i <= side; ++i) {
    const auto* row = gray_.ptr<std::uint8_t>(std::clamp(top + i, 0, gray_.rows - 1));
    double sum = 0;
    double sum_of_squares = 0;
    for (int k = 0; k <= side; ++k) {
      const double value = log_levels[row[std::clamp(left + k, 0, gray_.cols - 1)]];
      const double weighted = share(k, x - static_cast<int>(x)) * value;
      sum += weighted;
      sum_of_squares += weighted * value;
    }
    const double of_row = share(i, y - static_cast<int>(y));
    sums.mean += of_row * sum;
    sums.mean_square += of_row * sum_of_squares;
  }
  const double area = 1.0 * side * side;
  return {sums.mean / area, sums.mean_square / area};
}

double ContourMeasure::At(const Eigen::Vector2d& pixel) const {
  const auto mean_at = [&](const Eigen::Vector2d& offset) { return Around(pixel + offset).mean; };
  const double step = step_px_;
  const Eigen::Vector2d gradient(mean_at({step, 0}) - mean_at({-step, 0}), mean_at({0, step}) - mean_at({0, -step}));
  const double length = gradient.norm();
  if (length < 1e-6) return 0;
  const Eigen::Vector2d across = gradient / length;
  double within = 0;
  std::array<double, 2> side{};
  for (const int sign : {-1, 1}) {
    const Moments inner = Around(pixel + sign * step * across);
    const double slope = mean_at(sign * 2.0 * step * across) - inner.mean;
    side[sign < 0 ? 0 : 1] = inner.mean;
    within += std::max(0.0, inner.mean_square - inner.mean * inner.mean) + slope * slope;
  }
  const double between = (side[1] - side[0]) * (side[1] - side[0]);
  return between / (between + kWithinWeight * within + kMinLogStep * kMinLogStep);
}

}  // namespace pliant
