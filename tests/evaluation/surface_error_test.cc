// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/surface_error.h"

#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluation/pair_with_depth.h"
#include "pliant/base/random.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using testing::ElementsAre;

constexpr double kSurfaceNotFlat_mm = 1.0;   // the truth is no plane before the camera, so the null has an error
constexpr double kScaleDrift_mm = 2.0;       // a fifth of the distance, shared by two frames
constexpr double kOnePoint_mm = 1.0;         // all points in one, before a plane of many millimeters
constexpr double kRootMeanOf30000 = 0.0125;  // relative: half of 3 * sqrt(2 / 30000), which the mean square is right to
constexpr double kMedianOf10000_mm = 0.03;   // of 10,000 distances: more than four standard errors of a median
constexpr double kStep = 0.05;

Camera TestCamera() {
  constexpr std::array<double, 4> kParams = {60, 60, 31.5, 23.5};
  return *Camera::Create(CameraModelId::kPinhole, 64, 48, kParams);
}

// A curved surface whose depth is not the same in any two neighboring columns.
cv::Mat WavyDepth() {
  cv::Mat_<float> depth(48, 64);
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x) depth(y, x) = static_cast<float>(50 + 5 * std::sin(0.1 * x) + 0.1 * y);
  return depth;
}

std::vector<Eigen::Vector2d> Pixels(int count, Random random) {
  std::vector<Eigen::Vector2d> pixels;
  for (int i = 0; i < count; ++i) pixels.emplace_back(random.Uniform(0, 63), random.Uniform(0, 47));
  return pixels;
}

// The truth of the pixels, and estimates that are it divided by `scale`, with noise (mm, each axis).
PairedFrame Frame(int frame_idx, double scale, double noise_mm, int count = 200) {
  const Random random(100 + static_cast<std::uint64_t>(frame_idx));
  const std::vector<Eigen::Vector2d> pixels = Pixels(count, random.Child("pixels"));
  const std::vector<Eigen::Vector3d> nothing(pixels.size(), Eigen::Vector3d::Zero());
  PairedFrame frame = PairWithDepth(frame_idx, nothing, pixels, TestCamera(), WavyDepth(), kStep);
  Random noise = random.Child("noise");
  for (PointPair& pair : frame.pairs) {
    const Eigen::Vector3d error(noise.Normal(noise_mm), noise.Normal(noise_mm), noise.Normal(noise_mm));
    pair.estimate = (pair.truth + error) / scale;
  }
  return frame;
}

PointErrorOptions WithScale(ErrorScale scale) {
  PointErrorOptions options;
  options.scale = scale;
  return options;
}

TEST(SurfaceError, IsZeroForTheTruthItself) {
  for (const ErrorScale scale : {ErrorScale::kPerFrame, ErrorScale::kGlobal, ErrorScale::kNone}) {
    const auto error = ComputePointError(std::vector{Frame(0, 1, 0), Frame(1, 1, 0)}, WithScale(scale));
    ASSERT_TRUE(error.ok());
    EXPECT_LT(error->plain.estimate.mean_rmse_mm, kLengthRoundOff_mm);
    EXPECT_LT(error->plain.estimate.pooled_median_mm, kLengthRoundOff_mm);
    EXPECT_LT(error->plain.estimate.median_relative_depth, kLengthRoundOff_mm);
    EXPECT_GT(error->plain.null.mean_rmse_mm, kSurfaceNotFlat_mm);
    EXPECT_EQ(error->points, 400);
  }
}

TEST(SurfaceError, RecoversAKnownScaleExactly) {
  const std::vector frames = {Frame(0, 2.5, 0), Frame(1, 2.5, 0)};
  for (const ErrorScale scale : {ErrorScale::kPerFrame, ErrorScale::kGlobal}) {
    const auto error = ComputePointError(frames, WithScale(scale));
    ASSERT_TRUE(error.ok());
    EXPECT_NEAR(error->plain.estimate.min_scale, 2.5, kLengthRoundOff_mm);
    EXPECT_NEAR(error->plain.estimate.max_scale, 2.5, kLengthRoundOff_mm);
    EXPECT_LT(error->plain.estimate.pooled_rmse_mm, kLengthRoundOff_mm);
  }
  const auto unscaled = ComputePointError(frames, WithScale(ErrorScale::kNone));
  ASSERT_TRUE(unscaled.ok());
  EXPECT_NEAR(unscaled->plain.estimate.median_relative_depth, 1 - 1 / 2.5, kLengthRoundOff_mm);
}

TEST(SurfaceError, CountsDriftOfTheScaleOnlyUnderAGlobalScale) {
  const std::vector frames = {Frame(0, 1.0, 0), Frame(1, 1.2, 0)};
  EXPECT_LT(ComputePointError(frames, WithScale(ErrorScale::kPerFrame))->plain.estimate.mean_rmse_mm,
            kLengthRoundOff_mm);
  EXPECT_GT(ComputePointError(frames, WithScale(ErrorScale::kGlobal))->plain.estimate.mean_rmse_mm, kScaleDrift_mm);
}

TEST(SurfaceError, MatchesKnownNoise) {
  std::vector<PairedFrame> frames;
  for (int i = 0; i < 50; ++i) frames.push_back(Frame(i, 1, 0.8));
  const auto error = ComputePointError(frames, WithScale(ErrorScale::kNone));
  ASSERT_TRUE(error.ok());
  EXPECT_NEAR(error->plain.estimate.pooled_rmse_mm, 0.8 * std::sqrt(3.0), kRootMeanOf30000 * 0.8 * std::sqrt(3.0));
  // The median of a chi distribution of three degrees of freedom is 1.5382.
  EXPECT_NEAR(error->plain.estimate.pooled_median_mm, 0.8 * 1.5382, kMedianOf10000_mm);
}

TEST(SurfaceError, IsThePlainUntrimmedRmse) {
  PairedFrame frame;
  frame.pairs = {
      {{0, 0, 10}, {0, 0, 10}}, {{0, 3, 10}, {0, 0, 10}}, {{4, 0, 10}, {0, 0, 10}}, {{0, 0, 22}, {0, 0, 10}}};
  const auto error = ComputePointError(std::vector{frame}, WithScale(ErrorScale::kNone));
  ASSERT_TRUE(error.ok());
  EXPECT_NEAR(error->plain.estimate.mean_rmse_mm, std::sqrt((9 + 16 + 144) / 4.0), kLengthRoundOff_mm);
  EXPECT_NEAR(error->plain.estimate.pooled_median_mm, 3.5, kLengthRoundOff_mm);
  EXPECT_THAT(error->plain.estimate.within, ElementsAre(0.25, 0.75, 0.75, 1, 1));  // of 0, 3, 4 and 12 mm
  EXPECT_NEAR(error->plain.estimate.average_within, 0.75, kRoundOff);
}

TEST(SurfaceError, NullOfAPlaneAtConstantDepthIsZero) {
  const cv::Mat depth(48, 64, CV_32FC1, cv::Scalar::all(40));
  const std::vector<Eigen::Vector2d> pixels = Pixels(50, Random(3));
  const std::vector<Eigen::Vector3d> points(pixels.size(), Eigen::Vector3d(1, 2, 3));
  const auto frame = PairWithDepth(0, points, pixels, TestCamera(), depth, kStep);
  for (const ErrorScale scale : {ErrorScale::kPerFrame, ErrorScale::kGlobal, ErrorScale::kNone}) {
    const auto error = ComputePointError(std::vector{frame}, WithScale(scale));
    ASSERT_TRUE(error.ok());
    EXPECT_LT(error->plain.null.mean_rmse_mm, kFloatRoundOff_mm);
    EXPECT_NEAR(error->plain.null.min_scale, 40, kFloatRoundOff_mm);
    EXPECT_GT(error->plain.estimate.mean_rmse_mm, kOnePoint_mm);
  }
}

TEST(SurfaceError, TakesTheTruthAtThePixelItselfAndNotAtARoundedOne) {
  cv::Mat_<float> slanted(48, 64);
  for (int y = 0; y < slanted.rows; ++y)
    for (int x = 0; x < slanted.cols; ++x) slanted(y, x) = static_cast<float>(40 + 0.5 * x + 0.25 * y);
  const Eigen::Vector2d pixel(10.25, 20.5);
  const std::vector<Eigen::Vector3d> point = {{0, 0, 1}};
  const auto frame = PairWithDepth(0, point, std::vector{pixel}, TestCamera(), slanted, kStep);
  ASSERT_EQ(frame.pairs.size(), 1U);
  const double depth_mm = 40 + 0.5 * 10.25 + 0.25 * 20.5;
  const Eigen::Vector3d expected((10.25 - 31.5) / 60 * depth_mm, (20.5 - 23.5) / 60 * depth_mm, depth_mm);
  EXPECT_LT((frame.pairs[0].truth - expected).norm(), kFloatRoundOff_mm);
}

TEST(SurfaceError, LeavesOutDepthStepsHolesAndWhatHasNoTruthAndCountsThem) {
  cv::Mat_<float> depth(48, 64, 50.0F);
  depth(cv::Rect(32, 0, 32, 48)) = 60.0F;  // a step of 20 % between columns 31 and 32
  depth(10, 10) = 0;
  const std::vector<Eigen::Vector2d> pixels = {{31.5, 20}, {30.5, 20}, {32.5, 20}, {9.5, 9.5},
                                               {-0.1, 5},  {63.2, 5},  {63, 47},   {20, 20}};
  std::vector<Eigen::Vector3d> points(pixels.size(), Eigen::Vector3d(0, 0, 50));
  points.back().x() = std::nan("");
  const auto frame = PairWithDepth(0, points, pixels, TestCamera(), depth, kStep);
  EXPECT_EQ(frame.left_out.depth_step, 1);
  EXPECT_EQ(frame.left_out.no_depth, 1);
  EXPECT_EQ(frame.left_out.outside_image, 2);
  EXPECT_EQ(frame.left_out.not_finite, 1);
  EXPECT_EQ(frame.left_out.Total(), 5);
  EXPECT_EQ(frame.pairs.size(), 3U);
  EXPECT_EQ(PairWithDepth(0, points, pixels, TestCamera(), depth, 0.25).left_out.depth_step, 0);
}

TEST(SurfaceError, LeavesOutTruthThatIsUncertainAndSaysHowCertainTheRestIs) {
  const std::vector<Eigen::Vector2d> pixels = {{10, 10}, {20, 20}, {30, 30}};
  const std::vector<Eigen::Vector3d> points(pixels.size(), Eigen::Vector3d(0, 0, 50));
  const std::vector<DepthAtPixel> truth = {
      {DepthLookup::kOk, 50, 0.3}, {DepthLookup::kOk, 50, 1.2}, {DepthLookup::kOk, 50, 0.4}};
  const auto frame = PairWithSurface(0, points, {}, pixels, TestCamera(), truth, 1.0);
  EXPECT_EQ(frame.left_out.uncertain, 1);
  ASSERT_EQ(frame.pairs.size(), 2U);
  const auto error = ComputePointError(std::vector{frame}, {});
  ASSERT_TRUE(error.ok());
  EXPECT_NEAR(error->truth_sigma_mm, std::sqrt((0.09 + 0.16) / 2), kLengthRoundOff_mm);
}

TEST(SurfaceError, SaysWhyNothingCouldBeCompared) {
  PairedFrame frame;
  frame.left_out.depth_step = 7;
  const auto error = ComputePointError(std::vector{frame}, {});
  EXPECT_EQ(error.status().code(), ErrorCode::kInsufficient);
  EXPECT_THAT(error.status().message(), testing::HasSubstr("7 on a depth step"));
}

}  // namespace
}  // namespace pliant
