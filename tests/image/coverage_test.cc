// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/coverage.h"

#include <array>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace pliant {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr double kRadius_px = kWidth / 32.0;
constexpr double kCells = 0.25;  // relative: a circle of four cells' radius is counted in cells

cv::Mat AllValid() { return {kHeight, kWidth, CV_8UC1, cv::Scalar(255)}; }

TEST(Coverage, OfOnePointIsACircle) {
  const std::array pixels = {Eigen::Vector2d(320, 240)};
  const double circle = std::numbers::pi * kRadius_px * kRadius_px / (kWidth * kHeight);
  EXPECT_NEAR(CoverageOf(AllValid(), pixels), circle, kCells * circle);
}

TEST(Coverage, OfPointsEverywhereIsAll) {
  std::vector<Eigen::Vector2d> pixels;
  for (int y = 10; y < kHeight; y += 20)
    for (int x = 10; x < kWidth; x += 20) pixels.emplace_back(x, y);
  EXPECT_EQ(CoverageOf(AllValid(), pixels), 1.0);
}

TEST(Coverage, OfNoPointIsNothing) { EXPECT_EQ(CoverageOf(AllValid(), {}), 0.0); }

TEST(Coverage, CountsWhatShowsTheSceneAlone) {
  cv::Mat valid = AllValid();
  valid.colRange(0, kWidth / 2) = 0;
  std::vector<Eigen::Vector2d> pixels;
  for (int y = 10; y < kHeight; y += 20)
    for (int x = kWidth / 2 + 10; x < kWidth; x += 20) pixels.emplace_back(x, y);
  EXPECT_EQ(CoverageOf(valid, pixels), 1.0);
  for (Eigen::Vector2d& pixel : pixels) pixel.x() -= kWidth / 2.0;
  EXPECT_LT(CoverageOf(valid, pixels), 0.1);
  EXPECT_EQ(CoverageOf(cv::Mat::zeros(kHeight, kWidth, CV_8UC1), pixels), 0.0);
}

TEST(Coverage, IsThatOfTheSameImageAtAnotherSize) {
  const std::array small = {Eigen::Vector2d(100, 80), Eigen::Vector2d(500, 300)};
  const std::array large = {Eigen::Vector2d(300, 240), Eigen::Vector2d(1500, 900)};
  const cv::Mat of_large(3 * kHeight, 3 * kWidth, CV_8UC1, cv::Scalar(255));
  EXPECT_NEAR(CoverageOf(of_large, large), CoverageOf(AllValid(), small), 1e-3);
}

}  // namespace
}  // namespace pliant
