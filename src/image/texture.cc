// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/texture.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <opencv2/imgproc.hpp>

#include "pliant/image/masks.h"
#include "pliant/image/pyramid.h"

namespace pliant {
namespace {

constexpr double kSigmas = 3.0;
constexpr double kSobelUnit = 1.0 / 2.0;  // of differences between the pixels at either side

// What white noise that was smoothed gives the square of a gradient's component.
struct NoiseGradient {
  double mean = 0;     // by the square of the noise that ImageNoise measures
  double samples = 1;  // in how many pixels the squares vary as much as one that is independent
};

NoiseGradient OfNoise(double smoothing_px) {
  const int radius = 4 + static_cast<int>(std::ceil(4.0 * smoothing_px));
  cv::Mat response(4 * radius + 1, 4 * radius + 1, CV_64F, cv::Scalar(0));
  response.at<double>(2 * radius, 2 * radius) = 1.0;
  if (smoothing_px > 0.0) cv::GaussianBlur(response, response, {}, smoothing_px, smoothing_px, cv::BORDER_CONSTANT);
  const cv::Mat laplacians = (cv::Mat_<double>(3, 3) << 1, -2, 1, -2, 4, -2, 1, -2, 1);
  cv::Mat measured;
  cv::filter2D(response, measured, CV_64F, laplacians, {-1, -1}, 0, cv::BORDER_CONSTANT);
  cv::Mat gradient;
  cv::Sobel(response, gradient, CV_64F, 1, 0, 1, kSobelUnit, 0, cv::BORDER_CONSTANT);
  cv::Mat correlation;
  cv::filter2D(gradient, correlation, CV_64F, gradient, {-1, -1}, 0, cv::BORDER_CONSTANT);
  correlation /= gradient.dot(gradient);
  return {gradient.dot(gradient) / (measured.dot(measured) / 36.0), correlation.dot(correlation)};
}

float SmallerEigenvalue(float xx, float xy, float yy) { return 0.5F * (xx + yy - std::hypot(xx - yy, 2.0F * xy)); }

// Sums over the window, of what counts.
cv::Mat WindowSum(const cv::Mat& values, int window_px) {
  cv::Mat sum;
  cv::boxFilter(values, sum, CV_32F, {window_px, window_px}, {-1, -1}, false, cv::BORDER_CONSTANT);
  return sum;
}

}  // namespace

cv::Mat TexturedPixels(const cv::Mat& image, const cv::Mat& valid, const ComparedWindows& windows) {
  cv::Mat gray = ToGray(image);
  cv::Mat usable = valid;
  const cv::Size full = gray.size();
  if (windows.width_px < full.width) {
    const cv::Size size(windows.width_px,
                        static_cast<int>(std::lround(full.height * windows.width_px / (1.0 * full.width))));
    cv::resize(gray, gray, size, 0, 0, cv::INTER_AREA);
    cv::resize(valid, usable, size, 0, 0, cv::INTER_AREA);
    usable = usable == 255;
  }
  gray.convertTo(gray, CV_32F);
  if (windows.smoothing_px > 0.0) cv::GaussianBlur(gray, gray, {}, windows.smoothing_px, windows.smoothing_px);
  cv::Mat dx;
  cv::Mat dy;
  cv::Sobel(gray, dx, CV_32F, 1, 0, 1, kSobelUnit);
  cv::Sobel(gray, dy, CV_32F, 0, 1, 1, kSobelUnit);
  const cv::Mat unknown = ErodeMask(usable, 1) == 0;
  dx.setTo(0.0F, unknown);
  dy.setTo(0.0F, unknown);
  cv::Mat ones(gray.size(), CV_32F, cv::Scalar(1));
  ones.setTo(0.0F, unknown);
  const cv::Mat count = WindowSum(ones, windows.window_px);
  const cv::Mat xx = WindowSum(dx.mul(dx), windows.window_px);
  const cv::Mat xy = WindowSum(dx.mul(dy), windows.window_px);
  const cv::Mat yy = WindowSum(dy.mul(dy), windows.window_px);
  const NoiseGradient noise = OfNoise(windows.smoothing_px);
  const double mean = noise.mean * windows.noise_levels * windows.noise_levels;
  cv::Mat textured(gray.size(), CV_8U, cv::Scalar(0));
  for (int y = 0; y < textured.rows; ++y)
    for (int x = 0; x < textured.cols; ++x) {
      const double pixels = count.at<float>(y, x);
      if (usable.at<std::uint8_t>(y, x) == 0 || pixels < 1.0) continue;
      const double bound = mean * (pixels + kSigmas * std::sqrt(2.0 * noise.samples * pixels));
      if (SmallerEigenvalue(xx.at<float>(y, x), xy.at<float>(y, x), yy.at<float>(y, x)) > bound)
        textured.at<std::uint8_t>(y, x) = 255;
    }
  if (textured.size() != full) cv::resize(textured, textured, full, 0, 0, cv::INTER_NEAREST);
  textured &= valid;
  return textured;
}

}  // namespace pliant
