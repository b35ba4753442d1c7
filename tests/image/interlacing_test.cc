// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/interlacing.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace pliant {
namespace {

constexpr int kRows = 121;
constexpr int kColumns = 160;
constexpr double kPlain = 1.5;  // of images that are not interlaced
constexpr double kComb = 5;

// A smooth texture, moved to the left by `shift_px`.
cv::Mat ShiftedTexture(int shift_px, double noise) {
  cv::RNG random(3);
  cv::Mat texture(kRows, kColumns + 40, CV_32FC1);
  random.fill(texture, cv::RNG::NORMAL, 0, 1);
  cv::GaussianBlur(texture, texture, {}, 2.5);
  cv::normalize(texture, texture, 20, 220, cv::NORM_MINMAX);
  cv::Mat image = texture.colRange(shift_px, shift_px + kColumns).clone();
  cv::Mat grain(image.size(), CV_32FC1);
  random.fill(grain, cv::RNG::NORMAL, 0, noise);
  cv::Mat gray;
  cv::Mat(image + grain).convertTo(gray, CV_8UC1);
  return gray;
}

// Odd rows show the texture later.
cv::Mat Interlaced(int shift_px, double noise = 0.5) {
  cv::Mat image = ShiftedTexture(0, noise);
  const cv::Mat later = ShiftedTexture(shift_px, noise);
  for (int y = 1; y < image.rows; y += 2) later.row(y).copyTo(image.row(y));
  return image;
}

TEST(CombRatio, IsLargeWhereAnInterlacedImageMoves) {
  for (const int shift_px : {2, 4, 8}) EXPECT_GT(CombRatio(Interlaced(shift_px)), kComb) << shift_px;
  EXPECT_GT(CombRatio(Interlaced(4, 3)), kComb / 2) << "with noise";
  cv::Mat bgr;
  cv::cvtColor(Interlaced(4), bgr, cv::COLOR_GRAY2BGR);
  EXPECT_NEAR(CombRatio(bgr), CombRatio(Interlaced(4)), 0.05 * kComb);
}

TEST(CombRatio, IsAboutOneOtherwise) {
  for (const double noise : {0.0, 0.5, 10.0}) {
    EXPECT_LT(CombRatio(ShiftedTexture(0, noise)), kPlain) << noise;
    EXPECT_GT(CombRatio(ShiftedTexture(0, noise)), 1 / kPlain) << noise;
  }
  cv::Mat letterbox = ShiftedTexture(0, 0.5);
  letterbox.rowRange(0, 20).setTo(0);
  letterbox.rowRange(kRows - 20, kRows).setTo(0);
  EXPECT_LT(CombRatio(letterbox), kPlain);
  EXPECT_EQ(CombRatio(cv::Mat(40, 40, CV_8UC3, cv::Scalar(7, 7, 7))), 1.0);
  EXPECT_EQ(CombRatio(cv::Mat(1, 600, CV_8UC1, cv::Scalar(7))), 1.0);
}

TEST(WithoutOddRows, KeepsTheEvenOnesAndInterpolates) {
  const cv::Mat image = Interlaced(8);
  const cv::Mat before = image.clone();
  const cv::Mat even = WithoutOddRows(image);
  EXPECT_EQ(cv::norm(image, before, cv::NORM_INF), 0);
  ASSERT_EQ(even.size(), image.size());
  EXPECT_EQ(even.type(), image.type());
  const cv::Mat of_one_time = ShiftedTexture(0, 0.5);
  for (int y = 0; y < kRows; y += 2) EXPECT_EQ(cv::norm(even.row(y), image.row(y), cv::NORM_INF), 0) << y;
  EXPECT_LT(cv::norm(even, of_one_time, cv::NORM_L1) / even.total(), 2.5);
  EXPECT_GT(cv::norm(image, of_one_time, cv::NORM_L1) / even.total(), 10);
  EXPECT_LT(CombRatio(even), kPlain);
  cv::Mat two_rows(2, 10, CV_8UC3, cv::Scalar(1, 2, 3));
  two_rows.row(1).setTo(cv::Scalar(9, 9, 9));
  EXPECT_EQ(cv::norm(WithoutOddRows(two_rows), cv::Mat(2, 10, CV_8UC3, cv::Scalar(1, 2, 3)), cv::NORM_INF), 0);
}

}  // namespace
}  // namespace pliant
