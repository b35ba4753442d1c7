// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/texture.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace pliant {
namespace {

constexpr double kNoise = 4.0;
constexpr double kFalse = 0.005;  // of pixels with noise alone; three standard deviations leave 0.1 % to one side
constexpr double kFound = 0.99;   // of pixels with texture of ten times the noise
constexpr int kRim = 8;

const cv::Mat kAll(240, 320, CV_8U, cv::Scalar(255));

cv::Mat WithNoise(const cv::Mat& clean, double smoothing_px) {
  cv::Mat noise(clean.size(), CV_32F);
  cv::RNG(3).fill(noise, cv::RNG::NORMAL, 0.0, kNoise);
  cv::Mat image;
  cv::Mat(clean + noise).convertTo(image, CV_8U);
  if (smoothing_px > 0.0) cv::GaussianBlur(image, image, {}, smoothing_px);
  return image;
}

// Waves along x, and along y of another amplitude, gray levels.
cv::Mat Waves(double along_x, double along_y) {
  cv::Mat clean(kAll.size(), CV_32F);
  for (int y = 0; y < clean.rows; ++y)
    for (int x = 0; x < clean.cols; ++x)
      clean.at<float>(y, x) = static_cast<float>(120.0 + along_x * std::sin(0.6 * x) + along_y * std::sin(0.6 * y));
  return clean;
}

double Share(const cv::Mat& textured) {
  const cv::Mat inner = textured(cv::Rect(kRim, kRim, textured.cols - 2 * kRim, textured.rows - 2 * kRim));
  return static_cast<double>(cv::countNonZero(inner)) / static_cast<double>(inner.total());
}

TEST(TexturedPixels, HaveMoreThanNoise) {
  const ComparedWindows windows{320, 11, 0.0, kNoise};
  EXPECT_LT(Share(TexturedPixels(WithNoise(Waves(0, 0), 0), kAll, windows)), kFalse);
  EXPECT_GT(Share(TexturedPixels(WithNoise(Waves(40, 40), 0), kAll, windows)), kFound);
  // Noise that is said to be smaller than it is looks like texture.
  EXPECT_GT(Share(TexturedPixels(WithNoise(Waves(0, 0), 0), kAll, {320, 11, 0.0, 0.5 * kNoise})), kFound);
}

TEST(TexturedPixels, HaveItInEveryDirection) {
  const ComparedWindows windows{320, 11, 0.0, kNoise};
  EXPECT_LT(Share(TexturedPixels(WithNoise(Waves(40, 0), 0), kAll, windows)), kFalse);
  EXPECT_LT(Share(TexturedPixels(WithNoise(Waves(0, 40), 0), kAll, windows)), kFalse);
}

// Measured as ImageNoise does: by a filter to which white noise of 1 gives 6.
double Measured(const cv::Mat& image) {
  const cv::Mat kernel = (cv::Mat_<float>(3, 3) << 1, -2, 1, -2, 4, -2, 1, -2, 1);
  cv::Mat filtered;
  cv::filter2D(image, filtered, CV_32F, kernel);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(filtered, mean, deviation);
  return deviation[0] / 6.0;
}

TEST(TexturedPixels, NoiseThatWasSmoothedIsNone) {
  constexpr double kSmoothingPx = 1.0;
  const cv::Mat source = WithNoise(Waves(0, 0), 0);
  cv::Mat smooth;
  source.convertTo(smooth, CV_32F);
  cv::GaussianBlur(smooth, smooth, {}, kSmoothingPx);
  const ComparedWindows windows{320, 11, kSmoothingPx, Measured(smooth)};
  EXPECT_LT(Share(TexturedPixels(source, kAll, windows)), 2 * kFalse);
  EXPECT_GT(Share(TexturedPixels(WithNoise(Waves(40, 40), 0), kAll, windows)), kFound);
}

TEST(TexturedPixels, AreUsableAndOfTheImagesSize) {
  cv::Mat valid = kAll.clone();
  valid(cv::Rect(0, 0, 100, 240)).setTo(0);
  const cv::Mat textured = TexturedPixels(WithNoise(Waves(40, 40), 0), valid, {160, 7, 0.0, kNoise});
  ASSERT_EQ(textured.size(), kAll.size());
  EXPECT_EQ(cv::countNonZero(textured(cv::Rect(0, 0, 100, 240))), 0);
  EXPECT_GT(Share(textured(cv::Rect(100, 0, 220, 240))), kFound);
}

}  // namespace
}  // namespace pliant
