// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/photometric/stereo_matching.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pliant/base/statistics.h"
#include "pliant/image/corners.h"
#include "support/rendered_sequence.h"

namespace pliant {
namespace {

constexpr std::size_t kMinCorners = 100;  // of 300 asked for
constexpr double kMatched_px = 0.06;      // median: an alignment of patches that are not quite flat
constexpr double kSemiGlobal_px = 0.15;   // median: sixteenths of a pixel, and windows across edges
constexpr double kWrong_px = 1.0;         // is no noise any more
constexpr double kMaxShareWrong = 0.03;
constexpr int kByChance = 2;              // matches of noise that agree in both directions
constexpr double kGainMatters_px = 0.02;  // median: what rounding to fewer levels changes

struct Pair {
  cv::Mat left, right;
};

Pair RenderedPair() {
  const SimulatedFrame& frame = Rendered().frames.front();
  return {ToGray(frame.image), ToGray(frame.right)};
}

std::vector<Eigen::Vector2d> CornersOf(const cv::Mat& gray) {
  CornerOptions options;
  options.max_corners = 300;
  std::vector<Eigen::Vector2d> pixels;
  for (const Corner& corner : DetectCorners(gray, {}, {}, options)) pixels.push_back(corner.pixel);
  return pixels;
}

std::vector<std::optional<RowMatch>> Match(const Pair& pair, const std::vector<Eigen::Vector2d>& pixels,
                                           const StereoMatchingOptions& options, int threads = 1) {
  const SupportMask all(cv::Mat(pair.left.size(), CV_8UC1, cv::Scalar(255)));
  const LucasKanadeOptions lucas_kanade;
  return MatchAlongRows(ImagePyramid(pair.left, lucas_kanade.levels), all,
                        ImagePyramid(pair.right, lucas_kanade.levels), all, pixels, options, lucas_kanade, threads);
}

int Count(const std::vector<std::optional<RowMatch>>& matches) {
  return static_cast<int>(
      std::count_if(matches.begin(), matches.end(), [](const auto& match) { return match.has_value(); }));
}

class EveryMatcher : public testing::TestWithParam<StereoMatcher> {
 protected:
  StereoMatchingOptions Options() const {
    StereoMatchingOptions options;
    options.matcher = GetParam();
    return options;
  }
};

TEST_P(EveryMatcher, FindsTheDisparityThatTheDepthSays) {
  const Pair pair = RenderedPair();
  const std::vector<Eigen::Vector2d> pixels = CornersOf(pair.left);
  ASSERT_GT(pixels.size(), kMinCorners);
  const auto matches = Match(pair, pixels, Options());
  const double focal_baseline = Rendered().camera.params()[0] * Rendered().baseline_mm;
  std::vector<double> errors_px;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const auto depth_mm = SampleBilinear(Rendered().frames.front().depth, pixels[i].x(), pixels[i].y());
    if (matches[i] && depth_mm && *depth_mm > 0)
      errors_px.push_back(std::abs(matches[i]->disparity_px - focal_baseline / *depth_mm));
  }
  EXPECT_GT(errors_px.size(), pixels.size() / 2);
  EXPECT_LT(Median(errors_px), GetParam() == StereoMatcher::kPhotometric ? kMatched_px : kSemiGlobal_px);
  const auto wrong = std::count_if(errors_px.begin(), errors_px.end(), [](double error) { return error > kWrong_px; });
  EXPECT_LT(static_cast<double>(wrong), kMaxShareWrong * static_cast<double>(errors_px.size()));
}

TEST_P(EveryMatcher, IsTheSameOnAnyNumberOfThreads) {
  const Pair pair = RenderedPair();
  const std::vector<Eigen::Vector2d> pixels = CornersOf(pair.left);
  EXPECT_EQ(Match(pair, pixels, Options(), 1), Match(pair, pixels, Options(), 3));
}

TEST_P(EveryMatcher, FindsNothingWhereThereIsNothing) {
  const Pair pair = RenderedPair();
  const std::vector<Eigen::Vector2d> pixels = CornersOf(pair.left);
  const int found = Count(Match(pair, pixels, Options()));
  const cv::Mat black(pair.left.size(), CV_8UC1, cv::Scalar(0));
  EXPECT_EQ(Count(Match({black, black}, pixels, Options())), 0);
  EXPECT_EQ(Count(Match({pair.left, black}, pixels, Options())), 0);
  cv::Mat noise(pair.left.size(), CV_8UC1);
  cv::RNG(7).fill(noise, cv::RNG::UNIFORM, 0, 256);
  EXPECT_LE(Count(Match({pair.left, noise}, pixels, Options())), kByChance);
  cv::Mat turned;
  cv::rotate(pair.right, turned, cv::ROTATE_180);
  EXPECT_LT(Count(Match({pair.left, turned}, pixels, Options())), found / 4);
}

TEST_P(EveryMatcher, HasAMinimumOfTheDisparity) {
  const Pair pair = RenderedPair();
  const std::vector<Eigen::Vector2d> pixels = CornersOf(pair.left);
  StereoMatchingOptions options;
  options.matcher = GetParam();
  std::vector<double> disparities_px;
  for (const auto& match : Match(pair, pixels, options))
    if (match) disparities_px.push_back(match->disparity_px);
  options.min_disparity_px = Median(disparities_px);
  int matched = 0;
  for (const auto& match : Match(pair, pixels, options)) {
    if (!match) continue;
    ++matched;
    EXPECT_GE(match->disparity_px, options.min_disparity_px);
  }
  EXPECT_GT(matched, 0);
}

TEST_P(EveryMatcher, SurvivesCornersAtTheEdge) {
  const Pair pair = RenderedPair();
  const double right = pair.left.cols - 1.0;
  const double bottom = pair.left.rows - 1.0;
  const std::vector<Eigen::Vector2d> pixels = {{0, 0},          {right, 0},     {0, bottom},
                                               {right, bottom}, {right / 2, 0}, {3, 90}};
  EXPECT_EQ(Match(pair, pixels, Options()).size(), pixels.size());
}

INSTANTIATE_TEST_SUITE_P(StereoMatching, EveryMatcher,
                         testing::Values(StereoMatcher::kPhotometric, StereoMatcher::kSgbm),
                         [](const auto& test) { return std::string(EnumName(test.param)); });

TEST(StereoMatching, SwappedImagesMatchNowhere) {
  const Pair pair = RenderedPair();
  const std::vector<Eigen::Vector2d> pixels = CornersOf(pair.right);
  EXPECT_LT(Count(Match({pair.right, pair.left}, pixels, {})), static_cast<int>(pixels.size()) / 20);
}

TEST(StereoMatching, AGainBetweenTheEyesChangesLittle) {
  const Pair pair = RenderedPair();
  cv::Mat darker;
  pair.right.convertTo(darker, CV_8U, 0.6, 10);
  const std::vector<Eigen::Vector2d> pixels = CornersOf(pair.left);
  const auto as_it_is = Match(pair, pixels, {});
  const auto dark = Match({pair.left, darker}, pixels, {});
  EXPECT_GT(Count(dark), 8 * Count(as_it_is) / 10);
  std::vector<double> differences_px;
  for (std::size_t i = 0; i < pixels.size(); ++i)
    if (dark[i] && as_it_is[i]) differences_px.push_back(std::abs(dark[i]->disparity_px - as_it_is[i]->disparity_px));
  EXPECT_LT(Median(differences_px), kGainMatters_px);
}

TEST(StereoMatching, WhatIsPeriodicAlongTheRowIsNoMatch) {
  constexpr double kPi = std::numbers::pi;
  cv::Mat stripes(120, 320, CV_8UC1);
  for (int v = 0; v < stripes.rows; ++v)
    for (int u = 0; u < stripes.cols; ++u)
      stripes.at<unsigned char>(v, u) =
          cv::saturate_cast<unsigned char>(128 + 50 * std::sin(u * kPi / 8) + 50 * std::sin(v * kPi / 8));
  const std::vector<Eigen::Vector2d> pixels = {{150, 60}, {200, 40}, {250, 80}};
  EXPECT_EQ(Count(Match({stripes, stripes}, pixels, {})), 0);
}

}  // namespace
}  // namespace pliant
