// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Points that join a window which is solved already.
#include <vector>

#include <gtest/gtest.h>

#include "estimation/deforming_scene.h"
#include "estimation/window/window_samples.h"
#include "pliant/base/statistics.h"
#include "pliant/estimation/window/deforming_window.h"

namespace pliant {
namespace {

using deforming_test::DeformingScene;
using deforming_test::kFocalPx;
using deforming_test::kShape;
using deforming_test::kWithinThreeSigmas;

constexpr double kNoLessCertain = 1.1;   // sigmas come from another solution of the same window
constexpr double kSamePoints_mm = 0.05;  // two solutions that rest where the solver stops
constexpr double kUnknown = 1.0;         // of the logarithm: the depth may be three times as much

// A scene's solution, and what becomes of every fifth of its points when the others are solved without them.
struct JoiningScene {
  JoiningScene() {
    const DeformingWindow start = scene.Start(0);
    PointSample known;
    for (int i = 0; i < static_cast<int>(scene.points.size()); ++i) (i % 5 == 0 ? joining_points : known).push_back(i);
    std::vector<int> index(scene.points.size(), -1);
    for (std::size_t k = 0; k < joining_points.size(); ++k)
      index[static_cast<std::size_t>(joining_points[k])] = static_cast<int>(k);
    for (DeformingObservation seen : start.observations) {
      seen.point_idx = index[static_cast<std::size_t>(seen.point_idx)];
      if (seen.point_idx >= 0 && seen.view_idx >= 4) joining.push_back(seen);
    }
    solution = SolveDeformingWindow(PartOf(start, known), kFocalPx, {});
    order = known;
    order.insert(order.end(), joining_points.begin(), joining_points.end());
  }

  DeformingScene scene;
  PointSample joining_points;
  std::vector<DeformingObservation> joining;  // without the first four views
  PointSample order;                          // the scene's points, those that join last
  Result<DeformingSolution> solution = Status(ErrorCode::kInsufficient, "");
};

TEST(DeformingWindow, PointsJoinASolutionWhereTheirRaysAndNeighborsPutThem) {
  const JoiningScene of;
  ASSERT_TRUE(of.solution.ok());
  const auto num_joining = static_cast<int>(of.joining_points.size());
  const auto optimized = OptimizeDeformingPoints(*of.solution, of.joining, num_joining, kFocalPx, {});
  ASSERT_TRUE(optimized.ok()) << optimized.status().message();
  ASSERT_EQ(optimized->window.points_in_world.size(), of.scene.points.size());
  DeformingWindow in_order = optimized->window;
  std::vector<double> sigmas(of.order.size());
  for (std::size_t k = 0; k < of.order.size(); ++k) {
    const auto i = static_cast<std::size_t>(of.order[k]);
    in_order.points_in_world[i] = optimized->window.points_in_world[k];
    in_order.shapes[i] = optimized->window.shapes[k];
    sigmas[i] = optimized->LogDepthSigma(k);
  }
  const std::vector<double> errors = of.scene.DepthErrors(in_order, 12);
  std::vector<double> joined;
  int within = 0;
  for (const int i : of.joining_points) {
    joined.push_back(errors[static_cast<std::size_t>(i)]);
    within += joined.back() < 3 * sigmas[static_cast<std::size_t>(i)] ? 1 : 0;
  }
  EXPECT_LT(Median(joined), kShape);
  EXPECT_GT(within, kWithinThreeSigmas * num_joining);
  EXPECT_LT(Median(errors), kShape);
  // Views, coefficients and nodes are held.
  EXPECT_EQ(optimized->window.coefficients, of.solution->window.coefficients);
  EXPECT_EQ(optimized->nodes.shapes, of.solution->nodes.shapes);
}

TEST(DeformingWindow, WhatJoinsMakesTheOthersNoLessCertain) {
  const JoiningScene of;
  ASSERT_TRUE(of.solution.ok());
  const auto alone = OptimizeDeformingPoints(*of.solution, {}, 0, kFocalPx, {});
  std::vector<DeformingObservation> in_two_views = of.joining;
  std::erase_if(in_two_views, [](const DeformingObservation& seen) { return seen.view_idx > 5; });
  const auto with =
      OptimizeDeformingPoints(*of.solution, in_two_views, static_cast<int>(of.joining_points.size()), kFocalPx, {});
  ASSERT_TRUE(alone.ok() && with.ok());
  const std::size_t known = alone->log_depth_sigmas.size();
  ASSERT_GT(with->log_depth_sigmas.size(), known);
  for (std::size_t i = 0; i < known; ++i)
    EXPECT_LT((with->window.points_in_world[i] - alone->window.points_in_world[i]).norm(), kSamePoints_mm) << i;
  const std::vector<double> sigmas(with->log_depth_sigmas.begin(),
                                   with->log_depth_sigmas.begin() + static_cast<std::ptrdiff_t>(known));
  EXPECT_LT(Median(sigmas), kNoLessCertain * Median(alone->log_depth_sigmas));
}

TEST(DeformingWindow, JoiningDoesNotDependOnTheNumberOfThreads) {
  const JoiningScene of;
  ASSERT_TRUE(of.solution.ok());
  const auto num_joining = static_cast<int>(of.joining_points.size());
  const auto one = OptimizeDeformingPoints(*of.solution, of.joining, num_joining, kFocalPx, {}, 1);
  const auto two = OptimizeDeformingPoints(*of.solution, of.joining, num_joining, kFocalPx, {}, 2);
  ASSERT_TRUE(one.ok() && two.ok());
  EXPECT_EQ(one->window.points_in_world, two->window.points_in_world);
  EXPECT_EQ(one->log_depth_sigmas, two->log_depth_sigmas);
}

TEST(DeformingWindow, RefusesAPointThatJoinsFromNowhere) {
  const JoiningScene of;
  ASSERT_TRUE(of.solution.ok());
  std::vector<DeformingObservation> joining = of.joining;
  joining.front().point_idx = 1000;
  EXPECT_EQ(OptimizeDeformingPoints(*of.solution, joining, 40, kFocalPx, {}).status().code(),
            ErrorCode::kInvalidArgument);
  // One that is not seen keeps a position, and no certainty.
  const auto unseen = OptimizeDeformingPoints(*of.solution, {}, 1, kFocalPx, {});
  ASSERT_TRUE(unseen.ok());
  EXPECT_GT(unseen->LogDepthSigma(of.solution->window.points_in_world.size()), kUnknown);
}

}  // namespace
}  // namespace pliant
