// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/brightness.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace pliant {
namespace {

constexpr int kScale = 4;        // the average is taken on an image this much smaller ...
constexpr double kSigma = 1.25;  // ... with this standard deviation: 5 px of the image
constexpr float kMinValid = 0.05F;

}  // namespace

std::array<std::uint8_t, 3> ColorAt(const cv::Mat& image, const Eigen::Vector2d& pixel) {
  // Half a pixel outside is still the pixel at the edge.
  const cv::Point nearest(std::clamp(static_cast<int>(std::lround(pixel.x())), 0, image.cols - 1),
                          std::clamp(static_cast<int>(std::lround(pixel.y())), 0, image.rows - 1));
  if (image.channels() == 3) {
    const auto& bgr = image.at<cv::Vec3b>(nearest);
    return {bgr[2], bgr[1], bgr[0]};
  }
  const auto gray = image.at<std::uint8_t>(nearest);
  return {gray, gray, gray};
}

LocalBrightness::LocalBrightness(const cv::Mat& image, const cv::Mat& valid) {
  cv::Mat red = image;
  if (image.channels() == 3) cv::extractChannel(image, red, 2);
  cv::Mat weight = valid.empty() ? cv::Mat(image.size(), CV_8UC1, cv::Scalar(255)) : valid;
  cv::Mat surface = cv::Mat::zeros(image.size(), CV_8UC1);
  red.copyTo(surface, weight);
  const cv::Size size((image.cols + kScale - 1) / kScale, (image.rows + kScale - 1) / kScale);
  const auto average = [&](const cv::Mat& full) {
    cv::Mat small;
    cv::resize(full, small, size, 0, 0, cv::INTER_AREA);
    small.convertTo(small, CV_32FC1);
    cv::GaussianBlur(small, small, {}, kSigma);
    return small;
  };
  cv::Mat share = average(weight) / 255.0;
  cv::divide(average(surface), share, brightness_);
  brightness_.setTo(0, share < kMinValid);
}

double LocalBrightness::At(const Eigen::Vector2d& pixel) const {
  // Centers of pixels are at whole numbers in both images.
  const double x = (pixel.x() + 0.5) / kScale - 0.5;
  const double y = (pixel.y() + 0.5) / kScale - 0.5;
  if (!(x > -1.0) || !(y > -1.0) || !(x < brightness_.cols) || !(y < brightness_.rows)) return 0.0;
  const auto clamped = [](double value, int count) { return std::clamp(value, 0.0, static_cast<double>(count - 1)); };
  const double cx = clamped(x, brightness_.cols);
  const double cy = clamped(y, brightness_.rows);
  const int x0 = static_cast<int>(cx);
  const int y0 = static_cast<int>(cy);
  const int x1 = std::min(x0 + 1, brightness_.cols - 1);
  const int y1 = std::min(y0 + 1, brightness_.rows - 1);
  const double fx = cx - x0;
  const double fy = cy - y0;
  const auto value = [&](int row, int column) { return static_cast<double>(brightness_.at<float>(row, column)); };
  return (1 - fy) * ((1 - fx) * value(y0, x0) + fx * value(y0, x1)) +
         fy * ((1 - fx) * value(y1, x0) + fx * value(y1, x1));
}

}  // namespace pliant
