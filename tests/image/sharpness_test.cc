// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/sharpness.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace pliant {
namespace {

// The measure is gray levels a pixel; a blur of twice the width leaves about half of it.
constexpr double kSharp = 5;
constexpr double kLeftBySigma2 = 0.5;
constexpr double kLeftBySigma4 = 0.25;
constexpr double kHalfFlat = 0.85;  // half of the pixels count nothing
constexpr double kHalfSeen = 0.1;   // relative; another half of the same noise

cv::Mat Noise(int width) {
  cv::Mat noise(120, width, CV_8UC1);
  cv::RNG rng(5);
  rng.fill(noise, cv::RNG::UNIFORM, 50, 200);
  return noise;
}

cv::Mat Blurred(const cv::Mat& image, double sigma_px) {
  cv::Mat blurred;
  cv::GaussianBlur(image, blurred, cv::Size(), sigma_px);
  return blurred;
}

TEST(Sharpness, FallsWithBlur) {
  const cv::Mat image = Blurred(Noise(160), 1);
  const double sharp = Sharpness(image, {});
  EXPECT_GT(sharp, kSharp);
  EXPECT_LT(Sharpness(Blurred(image, 2), {}), kLeftBySigma2 * sharp);
  EXPECT_LT(Sharpness(Blurred(image, 4), {}), kLeftBySigma4 * sharp);
  EXPECT_EQ(Sharpness(cv::Mat(120, 160, CV_8UC1, cv::Scalar(80)), {}), 0);
}

TEST(Sharpness, OfALineIsThatOfItsPixels) {
  EXPECT_EQ(Sharpness(cv::Mat(1, 1, CV_8UC1, cv::Scalar(90)), {}), 0);
  EXPECT_EQ(Sharpness(cv::Mat(40, 1, CV_8UC1, cv::Scalar(90)), {}), 0);
}

TEST(Sharpness, IsThatOfTheUsablePixels) {
  cv::Mat image = Blurred(Noise(160), 1);
  cv::Mat valid(image.size(), CV_8UC1, cv::Scalar(255));
  const double all = Sharpness(image, valid);
  EXPECT_EQ(all, Sharpness(image, {}));
  image.colRange(80, 160) = 80;
  valid.colRange(76, 160) = 0;
  EXPECT_LT(Sharpness(image, {}), kHalfFlat * all);
  EXPECT_NEAR(Sharpness(image, valid), all, kHalfSeen * all);
}

}  // namespace
}  // namespace pliant
