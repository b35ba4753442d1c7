// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/window/deforming_window.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "estimation/deforming_scene.h"
#include "pliant/base/statistics.h"
#include "pliant/estimation/window/window_refinement.h"

namespace pliant {
namespace {

using deforming_test::DeformingScene;
using deforming_test::kFocalPx;
using deforming_test::kNoisePx;
using deforming_test::kShape;
using deforming_test::kWithinThreeSigmas;

constexpr double kRounding = 1e-9;     // mm, of a point through its chart and back
constexpr double kWithoutNoise = 0.5;  // of kShape: the scene is rigid, noise and priors are left
constexpr double kRigidShare = 0.1;    // of kShape: a window that knows that the scene is rigid has the noise alone
constexpr double kLessCertain = 1.5;   // half the views on half the way; by the way alone it would be two
constexpr double kSigmaLow = 0.5;      // of the light's own errors, whose deviation the solution finds
constexpr double kSigmaHigh = 3;       // and some of the correction for tilt, which this light does not have
constexpr double kAgain_mm = 0.05;     // two solutions that rest where the solver stops
constexpr double kMaxOfNoise = 0.15;   // correlation of residuals that are noise, of some thousand of them
constexpr double kOneOfFour = 0.2;     // of four neighbors' errors one is the same
constexpr double kMaxOfIndependent = 0.05;
constexpr double kMinOfMotion = 0.5;  // of residuals that are a motion of six times the noise

TEST(DeformingWindow, FindsTheShapeOfASceneThatMovesAsFastAsTheCamera) {
  const DeformingScene scene;
  const auto solution = SolveDeformingWindow(scene.Start(0), kFocalPx, {});
  ASSERT_TRUE(solution.ok()) << solution.status().message();
  EXPECT_EQ(solution->window.coefficients.rows(), DeformingWindowOptions().rank);
  EXPECT_EQ(solution->light_error, 0);
  for (const int view : {0, 6, 12}) EXPECT_LT(Median(scene.DepthErrors(solution->window, view)), kShape) << view;
  EXPECT_LT(Median(PointErrorsPx(solution->window, kFocalPx)), 2 * kNoisePx);
}

TEST(DeformingWindow, ARigidBundleAdjustmentOfThatSceneDoesNot) {
  const DeformingScene scene;
  const DeformingWindow start = scene.Start(0);
  Window rigid{start.cams_from_world, start.points_in_world, {}};
  for (const DeformingObservation& observation : start.observations)
    rigid.observations.push_back({observation.view_idx, observation.point_idx, observation.ray});
  const auto refined = RefineWindow(rigid, kFocalPx, WindowPoints::kRefined, {});
  ASSERT_TRUE(refined.ok());
  DeformingWindow window = start;
  window.points_in_world = refined->window.points_in_world;
  window.cams_from_world = refined->window.cams_from_world;
  EXPECT_GT(Median(scene.DepthErrors(window, 0)), 3 * kShape);
}

TEST(DeformingWindow, OfARigidSceneIsRigid) {
  DeformingScene scene;
  scene.amplitude_mm = 0;
  const auto solution = SolveDeformingWindow(scene.Start(0), kFocalPx, {});
  ASSERT_TRUE(solution.ok());
  EXPECT_LT(Median(scene.DepthErrors(solution->window, 0)), kWithoutNoise * kShape);
  EXPECT_LT(Median(scene.DepthErrors(solution->window, 12)), kWithoutNoise * kShape);
}

TEST(DeformingWindow, SaysHowUncertainItsDepthsAre) {
  const DeformingScene scene;
  const auto solution = SolveDeformingWindow(scene.Start(0), kFocalPx, {});
  ASSERT_TRUE(solution.ok());
  const std::vector<double> errors = scene.DepthErrors(solution->window, 0);
  int within = 0;
  for (std::size_t i = 0; i < errors.size(); ++i) within += errors[i] < 3 * solution->log_depth_sigmas[i] ? 1 : 0;
  EXPECT_GT(within, kWithinThreeSigmas * static_cast<double>(errors.size()));
  // ... and not by calling everything uncertain: with half the views, and half the way, it knows less.
  const auto shorter = SolveDeformingWindow(DeformingScene(6).Start(0), kFocalPx, {});
  ASSERT_TRUE(shorter.ok());
  EXPECT_GT(Median(shorter->log_depth_sigmas), kLessCertain * Median(solution->log_depth_sigmas));
}

TEST(DeformingWindow, TwoSamplesOfThePointsCheckOneAnother) {
  const DeformingScene scene;
  const auto solution = SolveDeformingWindow(scene.Start(0), kFocalPx, {});
  const auto shorter = SolveDeformingWindow(DeformingScene(6).Start(0), kFocalPx, {});
  ASSERT_TRUE(solution.ok() && shorter.ok());
  ASSERT_EQ(solution->sample_sigmas.size(), scene.points.size());
  EXPECT_LT(Median(solution->sample_sigmas), kShape);
  EXPECT_GT(Median(shorter->sample_sigmas), kLessCertain * Median(solution->sample_sigmas));
  // Fewer points than two samples take are solved all the same.
  const auto few = [](const DeformingScene& of) {
    DeformingWindow start = of.Start(0);
    start.points_in_world.resize(70);
    std::erase_if(start.observations, [](const DeformingObservation& seen) { return seen.point_idx >= 70; });
    return start;
  };
  const auto one_sample = SolveDeformingWindow(few(DeformingScene(13, 45)), kFocalPx, {});
  ASSERT_TRUE(one_sample.ok());
  EXPECT_TRUE(one_sample->sample_sigmas.empty());
  // ... and compared with the other motion of the plane where they are close to one.
  const auto nearly_flat = SolveDeformingWindow(few(DeformingScene(13, 5)), kFocalPx, {});
  ASSERT_TRUE(nearly_flat.ok());
  EXPECT_EQ(nearly_flat->sample_sigmas.size(), 70U);
}

TEST(DeformingWindow, TheLightTellsSolutionsApart) {
  const DeformingScene scene;
  const auto solution = SolveDeformingWindow(scene.Start(0.1), kFocalPx, {});
  ASSERT_TRUE(solution.ok());
  for (const int view : {0, 6, 12}) EXPECT_LT(Median(scene.DepthErrors(solution->window, view)), kShape) << view;
  // The median deviation of normal errors, and some of the correction for tilt, which this light does not have.
  EXPECT_GT(solution->light_error, kSigmaLow * 0.1 / kMedianToSigma);
  EXPECT_LT(solution->light_error, kSigmaHigh * 0.1 / kMedianToSigma);
}

TEST(DeformingWindow, DoesNotDependOnTheNumberOfThreads) {
  const DeformingWindow start = DeformingScene(7).Start(0.1);
  const auto one = SolveDeformingWindow(start, kFocalPx, {}, 1);
  const auto two = SolveDeformingWindow(start, kFocalPx, {}, 2);
  ASSERT_TRUE(one.ok() && two.ok());
  EXPECT_EQ(one->window.points_in_world, two->window.points_in_world);
  EXPECT_EQ(one->window.coefficients, two->window.coefficients);
  EXPECT_EQ(one->log_depth_sigmas, two->log_depth_sigmas);
  EXPECT_EQ(one->sample_sigmas, two->sample_sigmas);
  EXPECT_EQ(one->light_error, two->light_error);
}

TEST(DeformingWindow, OptimizesTheViewsBetween) {
  const DeformingScene scene;
  const auto solution = SolveDeformingWindow(scene.Start(0), kFocalPx, {});
  ASSERT_TRUE(solution.ok());
  DeformingWindow moved = solution->window;
  for (std::size_t v = 1; v < moved.cams_from_world.size(); ++v) moved.cams_from_world[v].translation.x() += 1.0;
  moved.coefficients.rightCols(moved.coefficients.cols() - 1) *= 0.8;
  const auto optimized = OptimizeDeformingViews(moved, kFocalPx, {});
  ASSERT_TRUE(optimized.ok());
  for (std::size_t v = 0; v < moved.cams_from_world.size(); ++v) {
    EXPECT_LT((optimized->cams_from_world[v].translation - solution->window.cams_from_world[v].translation).norm(),
              kAgain_mm);
    EXPECT_LT((optimized->points_in_world[v] - solution->window.points_in_world[v]).norm(), kRounding);
  }
}

TEST(DeformingWindow, RefusesWhatIsNoWindow) {
  const DeformingScene scene;
  DeformingWindow start = scene.Start(0);
  DeformingWindow unequal = start;
  unequal.times.pop_back();
  EXPECT_EQ(SolveDeformingWindow(unequal, kFocalPx, {}).status().code(), ErrorCode::kInvalidArgument);
  DeformingWindow foreign = start;
  foreign.observations.front().point_idx = 1000;
  EXPECT_EQ(SolveDeformingWindow(foreign, kFocalPx, {}).status().code(), ErrorCode::kInvalidArgument);
  DeformingWindow infinite = start;
  infinite.points_in_world[3].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(SolveDeformingWindow(infinite, kFocalPx, {}).status().code(), ErrorCode::kInvalidArgument);
  DeformingWindow again = start;
  again.times[2] = again.times[1];
  EXPECT_EQ(SolveDeformingWindow(again, kFocalPx, {}).status().code(), ErrorCode::kInvalidArgument);
  DeformingWindow blind = start;
  std::erase_if(blind.observations, [](const DeformingObservation& seen) { return seen.view_idx == 3; });
  EXPECT_EQ(SolveRigidWindow(blind, kFocalPx, {}).status().code(), ErrorCode::kDegenerate);
  DeformingWindowOptions rigid;
  rigid.rank = 0;
  EXPECT_EQ(SolveDeformingWindow(start, kFocalPx, rigid).status().code(), ErrorCode::kInvalidArgument);
  DeformingWindow few;
  EXPECT_EQ(SolveDeformingWindow(few, kFocalPx, {}).status().code(), ErrorCode::kInsufficient);
}

TEST(DeformingWindow, TellsARigidSceneFromOneThatDeformsALittle) {
  DeformingScene rigid;
  rigid.amplitude_mm = 0;
  DeformingScene breathing;
  breathing.amplitude_mm = 0.3;
  const auto still = RigidResidualCorrelation(rigid.Start(0), kFocalPx, {});
  const auto moving = RigidResidualCorrelation(breathing.Start(0), kFocalPx, {});
  ASSERT_TRUE(still.ok() && moving.ok());
  EXPECT_LT(*still, kMaxOfNoise);
  EXPECT_GT(*moving, kMinOfMotion);
}

// Points on a grid, each with a twin so near that their patches overlap: the errors of two twins are the same noise.
TEST(DeformingWindow, ErrorsOfPatchesThatOverlapAreNoSignOfMotion) {
  constexpr int kSide = 12;
  constexpr int kViews = 10;
  constexpr double kStep = 0.05;   // rad, of the grid
  constexpr double kTwin = 0.005;  // rad
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 1e-3);
  DeformingWindow window;
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column)
      for (const double twin : {0.0, kTwin})
        window.points_in_world.push_back(50.0 * Eigen::Vector3d(kStep * column + twin, kStep * row, 1));
  for (int v = 0; v < kViews; ++v) {
    window.times.push_back(v);
    window.cams_from_world.emplace_back();
    Eigen::Vector3d error = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < window.points_in_world.size(); ++i) {
      if (i % 2 == 0) error = {noise(random), noise(random), 0};
      window.observations.push_back(
          {v, static_cast<int>(i), (window.points_in_world[i].normalized() + error).normalized()});
    }
  }
  window.coefficients.resize(0, kViews);
  window.shapes.assign(window.points_in_world.size(), Eigen::Matrix3Xd(3, 0));
  EXPECT_GT(ResidualCorrelation(window, 0.0), kOneOfFour);
  EXPECT_LT(std::abs(ResidualCorrelation(window, 2 * kTwin)), kMaxOfIndependent);
}

TEST(DeformingWindow, SolvesARigidSceneAsOne) {
  DeformingScene scene;
  scene.amplitude_mm = 0;
  const auto solution = SolveRigidWindow(scene.Start(0), kFocalPx, {});
  ASSERT_TRUE(solution.ok()) << solution.status().message();
  EXPECT_EQ(solution->window.coefficients.rows(), 0);
  EXPECT_LT(std::abs(solution->residual_correlation), kMaxOfNoise);
  for (const int view : {0, 12}) {
    const std::vector<double> errors = scene.DepthErrors(solution->window, view);
    EXPECT_LT(Median(errors), kRigidShare * kShape);
    int within = 0;
    for (std::size_t i = 0; i < errors.size(); ++i) within += errors[i] < 3 * solution->log_depth_sigmas[i] ? 1 : 0;
    EXPECT_GT(within, kWithinThreeSigmas * static_cast<double>(errors.size()));
  }
}

}  // namespace
}  // namespace pliant
