// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/corners.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pliant/base/random.h"

namespace pliant {
namespace {

const cv::Size kSize(320, 240);
constexpr int kPerCell = 16;             // 192 corners in 12 cells
constexpr int kUneven = 6;               // cells whose best corners lie near each other get fewer, their neighbors more
constexpr std::size_t kMinCorners = 50;  // enough that one near a mask would be among them
constexpr double kContour = 0.7;         // the measure is 1 where two surfaces meet and all gradients agree ...
constexpr double kNoContour = 0.3;       // ... and near 0 where levels or textures are the same on both sides
constexpr int kMinOnContour = 5;         // an occluding contour is full of corners

// Blurred noise; its contrast falls to a quarter from left to right.
cv::Mat UnevenTexture(std::uint64_t seed, double level = 120, double contrast = 60) {
  Random random(seed);
  cv::Mat noise(kSize, CV_32F);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      noise.at<float>(y, x) = static_cast<float>(random.Normal(contrast) * (1 - 0.75 * x / kSize.width));
  cv::GaussianBlur(noise, noise, cv::Size(), 1.5);
  cv::Mat image;
  noise.convertTo(image, CV_8U, 1, level);
  return image;
}

CornerOptions Options(int count) {
  CornerOptions options;
  options.max_corners = count;
  return options;
}

TEST(DetectCorners, SpreadsThemEvenlyThoughContrastIsUneven) {
  const auto corners = DetectCorners(UnevenTexture(1), {}, {}, Options(192));
  ASSERT_EQ(corners.size(), 192u);
  std::array<int, 12> cells{};
  for (const Corner& c : corners)
    ++cells[static_cast<std::size_t>(static_cast<int>(c.pixel.y() / 80) * 4 + static_cast<int>(c.pixel.x() / 80))];
  for (const int count : cells) {
    EXPECT_GE(count, kPerCell - kUneven);
    EXPECT_LE(count, kPerCell + kUneven);
  }
}

TEST(DetectCorners, RepeatsAndKeepsItsDistances) {
  const cv::Mat image = UnevenTexture(2);
  const CornerOptions options = Options(500);
  const auto corners = DetectCorners(image, {}, {}, options);
  const auto again = DetectCorners(image, {}, {}, options);
  ASSERT_EQ(corners.size(), again.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    EXPECT_EQ(corners[i].pixel, again[i].pixel);
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_GE((corners[i].pixel - corners[j].pixel).norm(), options.min_distance_px);
  }
}

TEST(DetectCorners, StaysOffMasksEdgesAndExistingPoints) {
  cv::Mat valid(kSize, CV_8UC1, cv::Scalar(255));
  cv::circle(valid, {160, 120}, 30, cv::Scalar(0), cv::FILLED);
  const std::vector<Eigen::Vector2d> existing = {{60, 60}, {61, 180}, {250, 200}};
  const CornerOptions options = Options(500);
  const auto corners = DetectCorners(UnevenTexture(3), valid, existing, options);
  ASSERT_GT(corners.size(), kMinCorners);
  constexpr double kSubPixel = 0.5;
  for (const Corner& c : corners) {
    EXPECT_GT((c.pixel - Eigen::Vector2d(160, 120)).norm(), 30 + options.border_px - 1);
    EXPECT_GE(c.pixel.x(), options.border_px - kSubPixel);
    EXPECT_LE(c.pixel.y(), kSize.height - 1 - options.border_px + kSubPixel);
    for (const Eigen::Vector2d& p : existing) EXPECT_GE((c.pixel - p).norm(), options.min_distance_px);
  }
}

TEST(DetectCorners, AreNotMadeAgainWhereTheyAre) {
  CornerOptions options = Options(500);
  options.min_distance_px = 0;
  const cv::Mat texture = UnevenTexture(3);
  const cv::Mat valid(kSize, CV_8UC1, cv::Scalar(255));
  std::vector<Eigen::Vector2d> existing;
  for (const Corner& corner : DetectCorners(texture, valid, {}, options)) existing.push_back(corner.pixel);
  for (const Corner& corner : DetectCorners(texture, valid, existing, options))
    for (const Eigen::Vector2d& pixel : existing) ASSERT_GE((corner.pixel - pixel).norm(), 1);
}

// Corners of a bright square whose upper left corner lies at (100, 80) + shift / 8, drawn eight times too large.
std::vector<Corner> SquareCorners(int shift) {
  cv::Mat large(kSize.height * 8, kSize.width * 8, CV_8UC1, cv::Scalar(60));
  large(cv::Rect(100 * 8 + shift, 80 * 8 + shift, 60 * 8, 50 * 8)).setTo(180);
  cv::Mat image;
  cv::resize(large, image, kSize, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(image, image, cv::Size(), 1.5);  // as a lens does
  CornerOptions options = Options(4);
  options.contour_filter = Switch::kOff;
  options.quality_level = 0.3;
  return DetectCorners(image, {}, {}, options);
}

TEST(DetectCorners, FollowsASquareBySubPixelShifts) {
  constexpr double kParabola_px = 0.3;  // the response is no parabola; a whole-pixel answer errs by 0.5
  const Eigen::Vector2d shift(0.5, 0.5);
  const auto before = SquareCorners(0);
  const auto after = SquareCorners(4);
  ASSERT_EQ(before.size(), 4u);
  ASSERT_EQ(after.size(), 4u);
  for (const Corner& b : before) {
    const bool found = std::any_of(after.begin(), after.end(), [&](const Corner& a) {
      return (a.pixel - b.pixel - shift).cwiseAbs().maxCoeff() < kParabola_px;
    });
    EXPECT_TRUE(found) << b.pixel.transpose();
  }
}

TEST(DetectCorners, FindsNothingInBlackWhiteAndNearlyFlatImages) {
  for (const int level : {0, 128, 255})
    EXPECT_TRUE(DetectCorners(cv::Mat(kSize, CV_8UC1, cv::Scalar(level)), {}, {}, {}).empty());
}

double ContourColumn(double y) { return 160 + 6 * std::sin(y / 9); }

// A near bright textured surface covers the left up to ContourColumn, a far dark one the right.
cv::Mat Occlusion() {
  const cv::Mat near = UnevenTexture(5, 170, 12);
  cv::Mat image = UnevenTexture(6, 50, 12);
  for (int y = 0; y < kSize.height; ++y)
    near(cv::Rect(0, y, static_cast<int>(ContourColumn(y)), 1))
        .copyTo(image(cv::Rect(0, y, static_cast<int>(ContourColumn(y)), 1)));
  cv::GaussianBlur(image, image, cv::Size(), 0.8);
  return image;
}

TEST(ContourMeasure, IsHighOnAnOccludingContourAndLowOnTextureLinesAndShading) {
  const cv::Mat occlusion = Occlusion();
  EXPECT_GT(ContourMeasure(occlusion, 16).At({ContourColumn(120), 120}), kContour);
  EXPECT_LT(ContourMeasure(occlusion, 16).At({60, 120}), kNoContour);
  cv::Mat vessel(kSize, CV_8UC1, cv::Scalar(160));
  cv::line(vessel, {160, 0}, {160, 239}, cv::Scalar(80), 4);
  EXPECT_LT(ContourMeasure(vessel, 16).At({158, 120}), kNoContour);
  cv::Mat shading(kSize, CV_8UC1);
  for (int x = 0; x < kSize.width; ++x) {
    const int gray = 40 + x / 2;
    shading.col(x).setTo(gray);
  }
  EXPECT_LT(ContourMeasure(shading, 16).At({160, 120}), kNoContour);
}

TEST(DetectCorners, ContourFilterKeepsCornersOffAnOccludingContour) {
  const auto on_contour = [](const CornerOptions& options) {
    int count = 0;
    for (const Corner& c : DetectCorners(Occlusion(), {}, {}, options))
      count += std::abs(c.pixel.x() - ContourColumn(c.pixel.y())) < 4;
    return count;
  };
  CornerOptions options = Options(400);
  EXPECT_EQ(on_contour(options), 0);
  options.contour_filter = Switch::kOff;
  EXPECT_GT(on_contour(options), kMinOnContour);
}

}  // namespace
}  // namespace pliant
