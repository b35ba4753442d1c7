// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/pose/moving_point.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "pliant/base/random.h"

namespace pliant {
namespace {

constexpr double kMaxSigma = 0.02;    // of the logarithm of the distance: ten views of 0.5 px around the point
constexpr double kMaxRms = 1.5;       // in sigmas of noise; it would be one with many views
constexpr double kSpreadOf200 = 0.2;  // 200 trials fix a deviation to 5 %; four times that
constexpr double kNoiseRad = 0.5 / 450;
const Eigen::Vector3d kPoint(8, -5, 60);

// A camera that goes sideways and turns sees a point that swings with its surroundings.
std::vector<MovingPointView> Views(int count, double step_mm, double swing_mm, Random* random) {
  std::vector<MovingPointView> views;
  for (int k = 0; k < count; ++k) {
    MovingPointView view;
    view.cam_from_world =
        Rigid3(RotationExp(Eigen::Vector3d(0.01 * k, 0.005 * k, 0)), Eigen::Vector3d(-step_mm * k, 0, 0));
    view.displacement = swing_mm * std::sin(0.4 * k) * Eigen::Vector3d(0.3, 1, 0.2);
    const Eigen::Vector3d in_cam = view.cam_from_world * (kPoint + view.displacement);
    const Eigen::Vector3d noise(random->Normal(kNoiseRad), random->Normal(kNoiseRad), random->Normal(kNoiseRad));
    view.ray = (in_cam.normalized() + noise).normalized();
    views.push_back(view);
  }
  return views;
}

double LogDistanceError(const MovingPoint& point) { return std::log(point.position.norm() / kPoint.norm()); }

TEST(MovingPoint, IsFoundWhereItWasInTheFirstView) {
  Random random(1);
  const auto point = TriangulateMovingPoint(Views(10, 1.0, 3.0, &random), 30.0, kNoiseRad);
  ASSERT_TRUE(point.ok()) << point.status().message();
  EXPECT_LT(std::abs(LogDistanceError(*point)), 4 * point->log_distance_sigma);
  EXPECT_LT(point->log_distance_sigma, kMaxSigma);
  EXPECT_LT(point->rms, kMaxRms);
}

TEST(MovingPoint, ItsSigmaIsThatOfItsErrors) {
  Random random(2);
  double squares = 0;
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto point = TriangulateMovingPoint(Views(10, 1.0, 3.0, &random), 50.0, kNoiseRad);
    ASSERT_TRUE(point.ok());
    squares += std::pow(LogDistanceError(*point) / point->log_distance_sigma, 2);
  }
  EXPECT_NEAR(std::sqrt(squares / kTrials), 1.0, kSpreadOf200);
}

TEST(MovingPoint, SurroundingsThatAreLessKnownMakeItLessCertain) {
  Random random(3);
  std::vector<MovingPointView> views = Views(10, 1.0, 3.0, &random);
  const auto known = TriangulateMovingPoint(views, 50.0, kNoiseRad);
  for (std::size_t k = 0; k < views.size(); ++k) views[k].displacement_sigma = 0.05 * static_cast<double>(k);
  const auto unsure = TriangulateMovingPoint(views, 50.0, kNoiseRad);
  ASSERT_TRUE(known.ok() && unsure.ok());
  EXPECT_GT(unsure->log_distance_sigma, 2 * known->log_distance_sigma);
}

TEST(MovingPoint, AMotionThatItsSurroundingsDoNotShareShows) {
  Random random(4);
  std::vector<MovingPointView> views = Views(10, 1.0, 3.0, &random);
  for (MovingPointView& view : views) view.displacement.setZero();
  const auto point = TriangulateMovingPoint(views, 50.0, kNoiseRad);
  EXPECT_TRUE(!point.ok() || point->rms > 1.5);
}

TEST(MovingPoint, OneWrongViewCountsForLittle) {
  Random random(5);
  std::vector<MovingPointView> views = Views(20, 1.0, 0.0, &random);
  views[7].ray = (views[7].ray + Eigen::Vector3d(0.02, 0.01, 0)).normalized();  // 9 px
  const auto point = TriangulateMovingPoint(views, 50.0, kNoiseRad);
  ASSERT_TRUE(point.ok());
  EXPECT_LT(std::abs(LogDistanceError(*point)), 5 * point->log_distance_sigma);
}

// From a camera that stands still the prior alone says how far away the point is.
TEST(MovingPoint, APriorBoundsItsDistance) {
  Random random(7);
  const double log_distance = std::log(kPoint.norm());
  const auto views = Views(10, 0.0, 0.0, &random);
  const DistancePrior prior{std::log((views.back().cam_from_world * kPoint).norm()), 0.01};
  const auto point = TriangulateMovingPoint(views, 50.0, kNoiseRad, prior);
  ASSERT_TRUE(point.ok());
  EXPECT_NEAR(std::log(point->position.norm()), log_distance, 1e-3);
  EXPECT_NEAR(point->log_distance_sigma, 0.01, 1e-3);
}

TEST(MovingPoint, APriorThatManyViewsContradictCountsForLittle) {
  Random random(8);
  const auto views = Views(20, 2.0, 0.0, &random);
  const DistancePrior prior{std::log(0.5 * (views.back().cam_from_world * kPoint).norm()), 0.02};
  const auto point = TriangulateMovingPoint(views, 50.0, kNoiseRad, prior);
  ASSERT_TRUE(point.ok());
  EXPECT_LT(std::abs(LogDistanceError(*point)), kMaxSigma);
}

// A step that leads behind a view is refused, whatever was in memory before.
TEST(MovingPoint, IsTheSameWhateverMemoryHeld) {
  Random random(9);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<MovingPointView> views = Views(10, 3.0, 0.0, &random);
    for (MovingPointView& view : views) {
      view.cam_from_world.translation.z() -= random.Normal(30.0);
      view.ray = (view.ray + Eigen::Vector3d(random.Normal(0.5), random.Normal(0.5), 0)).normalized();
    }
    const auto after = [&](double left_behind) {
      std::vector<double> scratch;
      for (std::size_t n = 1; n < 64; ++n) scratch.assign(n, left_behind);
      scratch = {};
      const auto point = TriangulateMovingPoint(views, 60.0, kNoiseRad);
      return point.ok() ? point->position : Eigen::Vector3d(Eigen::Vector3d::Zero());
    };
    EXPECT_EQ(after(0.0), after(1e3)) << trial;
  }
}

TEST(MovingPoint, SaysWhatIsMissing) {
  Random random(6);
  EXPECT_EQ(TriangulateMovingPoint(Views(1, 1.0, 0.0, &random), 50.0, kNoiseRad).status().code(),
            ErrorCode::kInsufficient);
  EXPECT_EQ(TriangulateMovingPoint(Views(5, 1.0, 0.0, &random), 0.0, kNoiseRad).status().code(),
            ErrorCode::kInvalidArgument);
  EXPECT_EQ(TriangulateMovingPoint(Views(5, 1.0, 0.0, &random), 50.0, 0.0).status().code(),
            ErrorCode::kInvalidArgument);
  EXPECT_EQ(
      TriangulateMovingPoint(Views(5, 1.0, 0.0, &random), 50.0, kNoiseRad, DistancePrior{4.0, 0.0}).status().code(),
      ErrorCode::kInvalidArgument);
  // A camera that does not move: either it is said, or the sigma says it.
  const auto still = TriangulateMovingPoint(Views(10, 0.0, 0.0, &random), 50.0, kNoiseRad);
  EXPECT_TRUE(!still.ok() || still->log_distance_sigma > 1.0);
  std::vector<MovingPointView> views = Views(5, 1.0, 0.0, &random);
  views[2].ray.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(TriangulateMovingPoint(views, 50.0, kNoiseRad).ok());
  views = Views(5, 1.0, 0.0, &random);
  views[2].ray = -views[2].ray;
  EXPECT_EQ(TriangulateMovingPoint(views, 50.0, kNoiseRad).status().code(), ErrorCode::kDegenerate);
}

}  // namespace
}  // namespace pliant
