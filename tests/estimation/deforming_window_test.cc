// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/deforming_window.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "estimation/deforming_costs.h"
#include "estimation/light_depth.h"
#include "pliant/base/random.h"
#include "pliant/base/statistics.h"
#include "pliant/estimation/window_refinement.h"
#include "pliant/geometry/triangulation.h"

namespace pliant {
namespace {

constexpr double kFocalPx = 450;
constexpr double kNoisePx = 0.05;     // of a pixel followed well
constexpr double kShape = 0.02;       // median relative depth error; what the priors cost is below a third of it
constexpr double kDifference = 1e-5;  // of central differences with kStep, relative to entries of up to 1e3
constexpr double kStep = 1e-6;
constexpr double kRounding = 1e-9;  // mm, of a point through its chart and back

// A wavy surface that waves, seen by a camera that goes forwards and sways: neither motion is small against the other.
struct Scene {
  std::vector<Eigen::Vector3d> points;  // in the reference
  std::vector<Rigid3> poses;
  double amplitude_mm = 4;

  explicit Scene(int views = 13) {
    Random random(3);
    for (int i = 0; i < 150; ++i) {
      const double x = random.Uniform(-35, 35);
      const double y = random.Uniform(-25, 25);
      points.emplace_back(x, y, 60 + 15 * std::sin(x / 14) * std::cos(y / 18));
    }
    for (int v = 0; v < views; ++v) {
      const double t = 5.0 * v;
      poses.emplace_back(RotationExp(Eigen::Vector3d(0.02 * std::sin(0.05 * t), 0.01 * std::sin(0.08 * t), 0.001 * t)),
                         Eigen::Vector3d(0.5 * std::sin(0.06 * t), 0.4 * std::sin(0.05 * t), -0.5 * t));
    }
  }

  static double Time(int view) { return 5.0 * view; }

  // World frame.
  Eigen::Vector3d At(int point, int view) const {
    const Eigen::Vector3d& rest = points[static_cast<std::size_t>(point)];
    const double phase = 0.02 * rest.sum();
    return rest + Eigen::Vector3d(0, amplitude_mm * (std::sin(0.12 * Time(view) + phase) - std::sin(phase)), 0);
  }

  // All rays, with noise; every point at one distance, the views located against that.
  DeformingWindow Start(double light_sigma) const {
    Random random(4);
    DeformingWindow start;
    for (int v = 0; v < static_cast<int>(poses.size()); ++v) {
      start.times.push_back(Time(v));
      for (int i = 0; i < static_cast<int>(points.size()); ++i) {
        const Eigen::Vector3d x = poses[static_cast<std::size_t>(v)] * At(i, v);
        const double noise = kNoisePx / kFocalPx * x.norm();
        const Eigen::Vector3d seen = x + noise * Eigen::Vector3d(random.Normal(), random.Normal(), 0);
        DeformingObservation observation{v, i, seen.normalized()};
        if (light_sigma > 0) observation.log_light = std::log(x.norm()) + 1.7 + random.Normal(light_sigma);
        start.observations.push_back(observation);
        if (v == 0) start.points_in_world.push_back(60 * observation.ray);
      }
    }
    start.cams_from_world.push_back(Rigid3());
    for (int v = 1; v < static_cast<int>(poses.size()); ++v) {
      Window rigid{{Rigid3(), start.cams_from_world.back()}, start.points_in_world, {}};
      for (const DeformingObservation& observation : start.observations)
        if (observation.view_idx == v) rigid.observations.push_back({1, observation.point_idx, observation.ray});
      start.cams_from_world.push_back(
          RefineWindow(rigid, kFocalPx, WindowPoints::kFixed, {.loss_scale_px = 5}).value().window.cams_from_world[1]);
    }
    return start;
  }

  // Relative depth errors of a view after the best scale.
  std::vector<double> DepthErrors(const DeformingWindow& window, int view) const {
    std::vector<double> ratios;
    for (int i = 0; i < static_cast<int>(points.size()); ++i)
      ratios.push_back((window.cams_from_world[static_cast<std::size_t>(view)] * window.Position(i, view)).norm() /
                       (poses[static_cast<std::size_t>(view)] * At(i, view)).norm());
    const double scale = Median(ratios);
    for (double& ratio : ratios) ratio = std::abs(ratio / scale - 1);
    return ratios;
  }
};

TEST(DeformingWindow, FindsTheShapeOfASceneThatMovesAsFastAsTheCamera) {
  const Scene scene;
  const auto solution = SolveDeformingWindow(scene.Start(0), kFocalPx, {});
  ASSERT_TRUE(solution.ok()) << solution.status().message();
  EXPECT_EQ(solution->window.courses.rows(), DeformingWindowOptions().rank);
  EXPECT_EQ(solution->light_error, 0);
  for (const int view : {0, 6, 12}) EXPECT_LT(Median(scene.DepthErrors(solution->window, view)), kShape) << view;
  EXPECT_LT(Median(PointErrorsPx(solution->window, kFocalPx)), 2 * kNoisePx);
}

TEST(DeformingWindow, ARigidBundleAdjustmentOfThatSceneDoesNot) {
  const Scene scene;
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
  Scene scene;
  scene.amplitude_mm = 0;
  const auto solution = SolveDeformingWindow(scene.Start(0), kFocalPx, {});
  ASSERT_TRUE(solution.ok());
  EXPECT_LT(Median(scene.DepthErrors(solution->window, 0)), 0.5 * kShape);
  EXPECT_LT(Median(scene.DepthErrors(solution->window, 12)), 0.5 * kShape);
}

TEST(DeformingWindow, SaysHowUncertainItsDepthsAre) {
  const Scene scene;
  const auto solution = SolveDeformingWindow(scene.Start(0), kFocalPx, {});
  ASSERT_TRUE(solution.ok());
  const std::vector<double> errors = scene.DepthErrors(solution->window, 0);
  int within = 0;
  for (std::size_t i = 0; i < errors.size(); ++i) within += errors[i] < 3 * solution->log_depth_sigmas[i] ? 1 : 0;
  EXPECT_GT(within, 0.95 * static_cast<double>(errors.size()));
  // ... and not by calling everything uncertain: with half the views, and half the way, it knows less.
  const auto shorter = SolveDeformingWindow(Scene(6).Start(0), kFocalPx, {});
  ASSERT_TRUE(shorter.ok());
  EXPECT_GT(Median(shorter->log_depth_sigmas), 1.5 * Median(solution->log_depth_sigmas));
}

TEST(DeformingWindow, TwoSamplesOfThePointsCheckOneAnother) {
  const Scene scene;
  const auto solution = SolveDeformingWindow(scene.Start(0), kFocalPx, {});
  const auto shorter = SolveDeformingWindow(Scene(6).Start(0), kFocalPx, {});
  ASSERT_TRUE(solution.ok() && shorter.ok());
  ASSERT_EQ(solution->sample_sigmas.size(), scene.points.size());
  EXPECT_LT(Median(solution->sample_sigmas), kShape);
  EXPECT_GT(Median(shorter->sample_sigmas), 1.5 * Median(solution->sample_sigmas));
  // Fewer points than two samples take are solved all the same.
  DeformingWindow few = scene.Start(0);
  few.points_in_world.resize(70);
  std::erase_if(few.observations, [](const DeformingObservation& seen) { return seen.point_idx >= 70; });
  const auto one_sample = SolveDeformingWindow(few, kFocalPx, {});
  ASSERT_TRUE(one_sample.ok());
  EXPECT_TRUE(one_sample->sample_sigmas.empty());
}

TEST(DeformingWindow, TheLightTellsSolutionsApart) {
  const Scene scene;
  const auto solution = SolveDeformingWindow(scene.Start(0.1), kFocalPx, {});
  ASSERT_TRUE(solution.ok());
  for (const int view : {0, 6, 12}) EXPECT_LT(Median(scene.DepthErrors(solution->window, view)), kShape) << view;
  // The median deviation of normal errors, and some of the slope's correction, which this light does not have.
  EXPECT_GT(solution->light_error, 0.5 * 0.1 / kMedianToSigma);
  EXPECT_LT(solution->light_error, 3 * 0.1 / kMedianToSigma);
}

TEST(DeformingWindow, DoesNotDependOnTheNumberOfThreads) {
  const DeformingWindow start = Scene(7).Start(0.1);
  const auto one = SolveDeformingWindow(start, kFocalPx, {}, 1);
  const auto two = SolveDeformingWindow(start, kFocalPx, {}, 2);
  ASSERT_TRUE(one.ok() && two.ok());
  EXPECT_EQ(one->window.points_in_world, two->window.points_in_world);
  EXPECT_EQ(one->window.courses, two->window.courses);
  EXPECT_EQ(one->log_depth_sigmas, two->log_depth_sigmas);
  EXPECT_EQ(one->sample_sigmas, two->sample_sigmas);
  EXPECT_EQ(one->light_error, two->light_error);
}

TEST(DeformingWindow, LocatesTheViewsBetween) {
  const Scene scene;
  const auto solution = SolveDeformingWindow(scene.Start(0), kFocalPx, {});
  ASSERT_TRUE(solution.ok());
  DeformingWindow moved = solution->window;
  for (std::size_t v = 1; v < moved.cams_from_world.size(); ++v) moved.cams_from_world[v].translation.x() += 1.0;
  moved.courses.rightCols(moved.courses.cols() - 1) *= 0.8;
  const auto located = LocateDeformingViews(moved, kFocalPx, {});
  ASSERT_TRUE(located.ok());
  for (std::size_t v = 0; v < moved.cams_from_world.size(); ++v) {
    EXPECT_LT((located->cams_from_world[v].translation - solution->window.cams_from_world[v].translation).norm(), 0.05);
    EXPECT_LT((located->points_in_world[v] - solution->window.points_in_world[v]).norm(), kRounding);
  }
}

TEST(DeformingWindow, RefusesWhatIsNoWindow) {
  const Scene scene;
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
  DeformingWindowOptions rigid;
  rigid.rank = 0;
  EXPECT_EQ(SolveDeformingWindow(start, kFocalPx, rigid).status().code(), ErrorCode::kInvalidArgument);
  DeformingWindow few;
  EXPECT_EQ(SolveDeformingWindow(few, kFocalPx, {}).status().code(), ErrorCode::kInsufficient);
}

TEST(DeformingCosts, DerivativesMatchDifferences) {
  const PointChart chart = PointChart::Across(Eigen::Vector3d(0.3, -0.2, 1).normalized());
  const DeformingDirectionCost cost(chart, Eigen::Vector3d(0.25, -0.1, 1).normalized(), kFocalPx, 2);
  const Eigen::Vector4d rotation = RotationExp(Eigen::Vector3d(0.1, -0.2, 0.05)).coeffs();
  const Eigen::Vector3d translation(1, -2, 3);
  const Eigen::Vector3d point(0.01, -0.02, std::log(50.0));
  const Eigen::Vector2d courses(0.7, -1.1);
  const Eigen::Matrix<double, 6, 1> modes = Eigen::Matrix<double, 6, 1>::LinSpaced(-2, 3);
  std::array<Eigen::VectorXd, 5> blocks = {rotation, translation, point, courses, modes};
  const auto evaluate = [&](std::array<double*, 5> jacobians) {
    std::array<const double*, 5> parameters{};
    for (std::size_t b = 0; b < 5; ++b) parameters[b] = blocks[b].data();
    Eigen::Vector2d value;
    EXPECT_TRUE(cost.Evaluate(parameters.data(), value.data(), jacobians[0] == nullptr ? nullptr : jacobians.data()));
    return value;
  };
  std::array<Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor>, 5> analytic;
  std::array<double*, 5> pointers{};
  for (std::size_t b = 0; b < 5; ++b) {
    analytic[b].resize(2, blocks[b].size());
    pointers[b] = analytic[b].data();
  }
  evaluate(pointers);
  for (std::size_t b = 1; b < 5; ++b)  // a quaternion's are derivatives on the sphere alone, tested with RayResiduals
    for (Eigen::Index k = 0; k < blocks[b].size(); ++k) {
      const double kept = blocks[b][k];
      blocks[b][k] = kept + kStep;
      const Eigen::Vector2d after = evaluate({});
      blocks[b][k] = kept - kStep;
      const Eigen::Vector2d before = evaluate({});
      blocks[b][k] = kept;
      const Eigen::Vector2d difference = (after - before) / (2 * kStep);
      EXPECT_LT((difference - analytic[b].col(k)).norm(), kDifference * (1 + difference.norm())) << b << " " << k;
    }
}

TEST(LightDepth, ATiltedSurfaceIsDarkerNotFurther) {
  // A plane at 60 degrees: brightness = cosine / distance^2, response of gamma 2.2.
  std::vector<Eigen::Vector3d> positions;
  std::vector<double> light;
  std::vector<double> facing;
  const Eigen::Vector3d normal = Eigen::Vector3d(0, std::sin(1.0), -std::cos(1.0));
  for (int k = 0; k < 100; ++k) {
    const Eigen::Vector3d ray = Eigen::Vector3d(0.06 * (k % 10) - 0.27, 0.06 * (k / 10.0) - 0.27, 1).normalized();
    positions.push_back(-50.0 / normal.dot(ray) * ray);
    light.push_back(std::log(positions.back().norm()) - 0.4 * std::log(std::abs(normal.dot(ray))));
  }
  EXPECT_LT(LightError(positions, light), 0.01);
  // A surface at the same rays that is another one does not fit.
  std::vector<Eigen::Vector3d> flat;
  for (const Eigen::Vector3d& position : positions) flat.push_back(50 * position.normalized());
  EXPECT_GT(LightError(flat, light), 0.05);
  light.resize(10);
  positions.resize(10);
  EXPECT_EQ(LightError(positions, light), 0);
}

TEST(LightDepth, BrightnessFallsWithTheSquareOfTheDistance) {
  const double gamma = 2.2;
  const auto brightness = [&](double distance) { return 255 * std::pow(10.0 / (distance * distance), 1 / gamma); };
  EXPECT_NEAR(LogDistanceFromLight(brightness(20), gamma) - LogDistanceFromLight(brightness(10), gamma), std::log(2.0),
              1e-12);
  EXPECT_TRUE(std::isnan(LogDistanceFromLight(0, gamma)));
}

}  // namespace
}  // namespace pliant
