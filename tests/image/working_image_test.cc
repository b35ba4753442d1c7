// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/working_image.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace pliant {
namespace {

constexpr double kRounding_px = 1e-12;

// Of a blob's center: gray levels are rounded.
constexpr double kCentroid_px = 0.02;

cv::Mat Blob(const cv::Size& size, const Eigen::Vector2d& center, double sigma) {
  cv::Mat image(size, CV_8UC1);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      image.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(
          250 * std::exp(-0.5 * (Eigen::Vector2d(x, y) - center).squaredNorm() / (sigma * sigma)));
  return image;
}

Eigen::Vector2d CenterOf(const cv::Mat& image) {
  const cv::Moments m = cv::moments(image);
  return {m.m10 / m.m00, m.m01 / m.m00};
}

TEST(WorkingImage, APixelIsWhereTheResizedImageShowsIt) {
  const Eigen::Vector2d center(71.3, 40.6);
  const cv::Mat source = Blob({151, 97}, center, 6);
  for (const double scale : {0.25, 1.0 / 3.0, 0.5, 0.75, 1.0, 1.5, 2.0}) {
    const WorkingImage working{.scale = scale, .smoothing_px = 0.7};
    const cv::Mat image = working.Image(source);
    EXPECT_EQ(image.size(), working.SizeOf(source.size()));
    const Eigen::Vector2d expected = working.ToWorking(center);
    EXPECT_LT((CenterOf(image) - expected).norm(), kCentroid_px) << scale;
    EXPECT_LT((working.ToSource(expected) - center).norm(), kRounding_px) << scale;
  }
}

TEST(WorkingImage, TheSourceIsNeverWrittenTo) {
  const cv::Mat source = Blob({60, 40}, {30, 20}, 3);
  const cv::Mat before = source.clone();
  for (const double scale : {0.5, 1.0, 2.0})
    for (const double smoothing_px : {0.0, 1.0}) {
      const WorkingImage working{scale, smoothing_px};
      EXPECT_FALSE(working.Image(source).empty());
      EXPECT_EQ(cv::norm(source, before, cv::NORM_INF), 0) << scale << ", " << smoothing_px;
    }
}

TEST(WorkingImage, TheSourceItselfIsGivenWhereNothingChanges) {
  const cv::Mat source = Blob({60, 40}, {30, 20}, 3);
  EXPECT_EQ(WorkingImage{}.Image(source).data, source.data);
  EXPECT_NE(WorkingImage{.interlaced = true}.Image(source).data, source.data);
  EXPECT_EQ(WorkingImage{}.Nearest(source).data, source.data);
  EXPECT_TRUE(WorkingImage{.scale = 2}.Nearest(cv::Mat()).empty());
}

TEST(WorkingImage, MasksAndDepthsGetNoNewValues) {
  cv::Mat depth(40, 60, CV_32FC1, cv::Scalar(50));
  depth(cv::Rect(30, 0, 30, 40)) = 90;
  for (const double scale : {0.5, 1.5}) {
    const cv::Mat nearest = WorkingImage{.scale = scale, .smoothing_px = 1}.Nearest(depth);
    EXPECT_EQ(cv::countNonZero(nearest == 50) + cv::countNonZero(nearest == 90), static_cast<int>(nearest.total()));
  }
}

TEST(WorkingImage, SmoothingTakesNoiseAway) {
  cv::Mat noise(120, 160, CV_8UC1);
  cv::RNG random(7);
  random.fill(noise, cv::RNG::NORMAL, 128, 8);
  cv::Scalar mean, before, after;
  cv::meanStdDev(noise, mean, before);
  cv::meanStdDev(WorkingImage{.smoothing_px = 1}.Image(noise), mean, after);
  EXPECT_LT(after[0], before[0] / 3);  // 1 / (2 sqrt(pi)) = 0.28 of white noise
}

}  // namespace
}  // namespace pliant
