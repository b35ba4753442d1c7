// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/uncertainty_error.h"

#include <cmath>

#include <gtest/gtest.h>

#include "pliant/base/random.h"

namespace pliant {
namespace {

constexpr int kDraws = 20000;
constexpr double kShare = 0.015;  // of 20,000: more than four standard errors

// Points at 40 to 80 mm before the camera in four frames whose unit is `unit_mm`, each off along its ray by as much as
// its own sigma says, times `factor`.
std::vector<PairedFrame> Frames(double factor, double unit_mm) {
  Random random(5);
  std::vector<PairedFrame> frames(4);
  for (int i = 0; i < kDraws; ++i) {
    PairedFrame& frame = frames[static_cast<std::size_t>(i % 4)];
    frame.frame_idx = i % 4;
    const Eigen::Vector3d ray(random.Uniform(-0.3, 0.3), random.Uniform(-0.3, 0.3), 1);
    const Eigen::Vector3d truth = random.Uniform(40, 80) * ray;
    const double sigma_mm = random.Uniform(0.02, 0.4);
    const double distance = truth.norm() + factor * random.Normal(sigma_mm);
    frame.pairs.push_back({distance / unit_mm * truth.normalized(), truth, ray, 0, sigma_mm / unit_mm});
  }
  return frames;
}

UncertaintyError Judged(const std::vector<PairedFrame>& frames) {
  return ComputeUncertaintyError(frames, ComputePointError(frames, {}).value()).value();
}

TEST(UncertaintyError, OfRightSigmasIsThatOfANormalDistribution) {
  for (const double unit_mm : {1.0, 12.5}) {
    const UncertaintyError error = Judged(Frames(1, unit_mm));
    EXPECT_EQ(error.points, kDraws);
    EXPECT_EQ(error.points_without, 0);
    EXPECT_NEAR(error.within_1_sigma, 0.683, kShare) << unit_mm;
    EXPECT_NEAR(error.within_2_sigma, 0.954, kShare);
    EXPECT_NEAR(error.nees, 1, 0.05);
    EXPECT_NEAR(error.median_ratio, 1, 0.05);
    ASSERT_EQ(error.bins.size(), 10U);
    for (const UncertaintyBin& bin : error.bins) EXPECT_NEAR(bin.rmse_mm / bin.sigma_mm, 1, 0.1);
    EXPECT_LT(error.bins.front().sigma_mm, error.bins.back().sigma_mm);
  }
}

// Right sigmas, compared with a truth that has an error of its own.
TEST(UncertaintyError, KnowsThatTheTruthIsUncertainToo) {
  Random random(6);
  std::vector<PairedFrame> frames = Frames(1, 1);
  for (PairedFrame& frame : frames)
    for (PointPair& pair : frame.pairs) {
      pair.truth_sigma_mm = 0.3;
      pair.truth *= 1 + random.Normal(pair.truth_sigma_mm) / pair.truth.z();
    }
  const UncertaintyError error = Judged(frames);
  EXPECT_NEAR(error.within_1_sigma, 0.683, kShare);
  EXPECT_NEAR(error.nees, 1, 0.05);
}

TEST(UncertaintyError, SaysThatSigmasAreTooSmall) {
  const UncertaintyError error = Judged(Frames(2, 1));
  EXPECT_NEAR(error.within_1_sigma, 0.383, kShare);  // of a normal distribution, within half its standard deviation
  EXPECT_NEAR(error.within_2_sigma, 0.683, kShare);
  EXPECT_NEAR(error.nees, 4, 0.2);
  EXPECT_NEAR(error.median_ratio, 2, 0.1);
}

// Without its least certain half, a set with sigmas from 0.02 to 0.4 has those from 0.02 to 0.21.
TEST(UncertaintyError, SparsificationIsBetweenTheOracleAndNothing) {
  const UncertaintyError error = Judged(Frames(1, 1));
  const auto rms = [](double low, double high) {
    return std::sqrt((std::pow(high, 3) - std::pow(low, 3)) / (3 * (high - low)));
  };
  EXPECT_EQ(error.curve[0], 1);
  EXPECT_NEAR(error.curve[UncertaintyError::kSteps / 2], rms(0.02, 0.21) / rms(0.02, 0.4), 0.02);
  for (int k = 1; k < UncertaintyError::kSteps; ++k) {
    EXPECT_LE(error.oracle[k], error.oracle[k - 1]);
    EXPECT_LE(error.oracle[k], error.curve[k]);
  }
  EXPECT_LT(error.oracle_area, error.area);
  EXPECT_LT(error.area, 0.8);

  std::vector<PairedFrame> same = Frames(1, 1);
  for (PairedFrame& frame : same)
    for (PointPair& pair : frame.pairs) pair.sigma = 0.2;
  EXPECT_NEAR(Judged(same).area, 1, 0.03) << "sigmas that say nothing";
}

TEST(UncertaintyError, CountsPointsThatSayNothing) {
  std::vector<PairedFrame> frames = Frames(1, 1);
  frames[0].pairs[7].sigma = 0;
  EXPECT_EQ(Judged(frames).points, kDraws - 1);
  EXPECT_EQ(Judged(frames).points_without, 1);
  for (PairedFrame& frame : frames)
    for (PointPair& pair : frame.pairs) pair.sigma = 0;
  EXPECT_EQ(ComputeUncertaintyError(frames, ComputePointError(frames, {}).value()).status().code(),
            ErrorCode::kInsufficient);
}

}  // namespace
}  // namespace pliant
