// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/brightness.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

constexpr double kBrightened = 110;       // gray levels: what the highlight adds to the surface's 100, and more
constexpr double kHighlightRim = 2.0;     // gray levels: the highlight's rim shares pixels of the average
constexpr double kAverageRounding = 0.6;  // gray levels: averages are taken of whole levels

TEST(LocalBrightness, IsThatOfTheRedChannel) {
  const cv::Mat image(60, 80, CV_8UC3, cv::Scalar(200, 100, 50));
  EXPECT_NEAR(LocalBrightness(image, {}).At({40, 30}), 50, kAverageRounding);
  EXPECT_NEAR(LocalBrightness(cv::Mat(60, 80, CV_8UC1, cv::Scalar(70)), {}).At({0, 59}), 70, kAverageRounding);
}

TEST(ColorAt, TakesTheEdgeForHalfAPixelOutside) {
  cv::Mat image(60, 80, CV_8UC1, cv::Scalar(0));
  image.at<std::uint8_t>(0, 0) = 10;
  image.at<std::uint8_t>(59, 79) = 20;
  EXPECT_EQ(ColorAt(image, {-0.5, -0.5})[0], 10);
  EXPECT_EQ(ColorAt(image, {79.5, 59.5})[0], 20);
}

TEST(LocalBrightness, LeavesOutWhatIsNotTheSurface) {
  cv::Mat image(60, 80, CV_8UC3, cv::Scalar(0, 0, 100));
  cv::Mat valid(60, 80, CV_8UC1, cv::Scalar(255));
  const cv::Rect highlight(36, 26, 8, 8);
  image(highlight).setTo(cv::Scalar(255, 255, 255));
  EXPECT_GT(LocalBrightness(image, valid).At({40, 30}), kBrightened);
  valid(highlight).setTo(0);
  EXPECT_NEAR(LocalBrightness(image, valid).At({40, 30}), 100, kHighlightRim);
  valid.setTo(0);
  EXPECT_EQ(LocalBrightness(image, valid).At({40, 30}), 0);
}

TEST(LocalBrightness, FollowsTheImageToAFractionOfAPixel) {
  cv::Mat image(64, 128, CV_8UC1);
  for (int x = 0; x < image.cols; ++x) image.col(x).setTo(2 * x);
  const LocalBrightness brightness(image, {});
  for (const double x : {40.0, 41.3, 61.9, 80.5}) EXPECT_NEAR(brightness.At({x, 30.2}), 2 * x, kAverageRounding);
  EXPECT_EQ(brightness.At({-20, 30}), 0);
  EXPECT_EQ(brightness.At({40, 300}), 0);
}

}  // namespace
}  // namespace pliant
