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

#include "estimation/deforming_equations.h"
#include "estimation/deforming_terms.h"
#include "estimation/light_depth.h"
#include "estimation/shape_basis.h"
#include "estimation/view_equations.h"
#include "estimation/window_samples.h"
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

constexpr double kWithoutNoise = 0.5;  // of kShape: the scene is rigid, noise and priors are left
constexpr double kRigidShare = 0.1;    // of kShape: a window that knows that the scene is rigid has the noise alone
constexpr double kWithinThreeSigmas = 0.95;  // of the errors; fewer than 99.7 %, for points share errors
constexpr double kLessCertain = 1.5;         // half the views on half the way; by the way alone it would be two
constexpr double kNoLessCertain = 1.1;       // sigmas come from another solution of the same window
constexpr double kSigmaLow = 0.5;            // of the light's own errors, whose deviation the solution finds
constexpr double kSigmaHigh = 3;             // and some of the correction for tilt, which this light does not have
constexpr double kAgain_mm = 0.05;           // two solutions that rest where the solver stops
constexpr double kUnknown = 1.0;             // of the logarithm: the depth may be three times as much
constexpr double kMaxOfNoise = 0.15;         // correlation of residuals that are noise, of some thousand of them
constexpr double kMinOfMotion = 0.5;         // of residuals that are a motion of six times the noise
constexpr std::size_t kMaxNodes = 4;         // nodes that share a point
constexpr double kSameSurface = 0.01;        // of logarithms of distances: what the correction for tilt leaves
constexpr double kOtherSurface = 0.05;       // a tilted plane is no sphere: by up to some tenths
constexpr double kDirectional = 1e-4;        // relative to both lengths; kDifference, times a cosine that may be small
constexpr double kStepped = 1e-5;            // relative; the step solves the equations to the solver's precision

// A wavy surface that waves, seen by a camera that goes forwards and sways: neither motion is small against the other.
struct Scene {
  std::vector<Eigen::Vector3d> points;  // in the reference
  std::vector<Rigid3> poses;
  double amplitude_mm = 4;

  explicit Scene(int views = 13, double relief_mm = 15) {
    Random random(3);
    for (int i = 0; i < 150; ++i) {
      const double x = random.Uniform(-35, 35);
      const double y = random.Uniform(-25, 25);
      points.emplace_back(x, y, 60 + relief_mm * std::sin(x / 14) * std::cos(y / 18));
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

  // All rays, with noise; every point at one distance, the views optimized against that.
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
  EXPECT_EQ(solution->window.coefficients.rows(), DeformingWindowOptions().rank);
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
  EXPECT_LT(Median(scene.DepthErrors(solution->window, 0)), kWithoutNoise * kShape);
  EXPECT_LT(Median(scene.DepthErrors(solution->window, 12)), kWithoutNoise * kShape);
}

TEST(DeformingWindow, SaysHowUncertainItsDepthsAre) {
  const Scene scene;
  const auto solution = SolveDeformingWindow(scene.Start(0), kFocalPx, {});
  ASSERT_TRUE(solution.ok());
  const std::vector<double> errors = scene.DepthErrors(solution->window, 0);
  int within = 0;
  for (std::size_t i = 0; i < errors.size(); ++i) within += errors[i] < 3 * solution->log_depth_sigmas[i] ? 1 : 0;
  EXPECT_GT(within, kWithinThreeSigmas * static_cast<double>(errors.size()));
  // ... and not by calling everything uncertain: with half the views, and half the way, it knows less.
  const auto shorter = SolveDeformingWindow(Scene(6).Start(0), kFocalPx, {});
  ASSERT_TRUE(shorter.ok());
  EXPECT_GT(Median(shorter->log_depth_sigmas), kLessCertain * Median(solution->log_depth_sigmas));
}

TEST(DeformingWindow, TwoSamplesOfThePointsCheckOneAnother) {
  const Scene scene;
  const auto solution = SolveDeformingWindow(scene.Start(0), kFocalPx, {});
  const auto shorter = SolveDeformingWindow(Scene(6).Start(0), kFocalPx, {});
  ASSERT_TRUE(solution.ok() && shorter.ok());
  ASSERT_EQ(solution->sample_sigmas.size(), scene.points.size());
  EXPECT_LT(Median(solution->sample_sigmas), kShape);
  EXPECT_GT(Median(shorter->sample_sigmas), kLessCertain * Median(solution->sample_sigmas));
  // Fewer points than two samples take are solved all the same.
  const auto few = [](const Scene& of) {
    DeformingWindow start = of.Start(0);
    start.points_in_world.resize(70);
    std::erase_if(start.observations, [](const DeformingObservation& seen) { return seen.point_idx >= 70; });
    return start;
  };
  const auto one_sample = SolveDeformingWindow(few(Scene(13, 45)), kFocalPx, {});
  ASSERT_TRUE(one_sample.ok());
  EXPECT_TRUE(one_sample->sample_sigmas.empty());
  // ... and compared with the other motion of the plane where they are close to one.
  const auto nearly_flat = SolveDeformingWindow(few(Scene(13, 5)), kFocalPx, {});
  ASSERT_TRUE(nearly_flat.ok());
  EXPECT_EQ(nearly_flat->sample_sigmas.size(), 70U);
}

TEST(DeformingWindow, TheLightTellsSolutionsApart) {
  const Scene scene;
  const auto solution = SolveDeformingWindow(scene.Start(0.1), kFocalPx, {});
  ASSERT_TRUE(solution.ok());
  for (const int view : {0, 6, 12}) EXPECT_LT(Median(scene.DepthErrors(solution->window, view)), kShape) << view;
  // The median deviation of normal errors, and some of the correction for inclination, which this light does not have.
  EXPECT_GT(solution->light_error, kSigmaLow * 0.1 / kMedianToSigma);
  EXPECT_LT(solution->light_error, kSigmaHigh * 0.1 / kMedianToSigma);
}

TEST(DeformingWindow, DoesNotDependOnTheNumberOfThreads) {
  const DeformingWindow start = Scene(7).Start(0.1);
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
  const Scene scene;
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

// A scene's solution, and what becomes of every fifth of its points when the others are solved without them.
struct JoiningScene {
  JoiningScene() {
    const DeformingWindow start = scene.Start(0);
    PointSample known;
    for (int i = 0; i < static_cast<int>(scene.points.size()); ++i) (i % 5 == 0 ? joining_points : known).push_back(i);
    std::vector<int> new_idx(scene.points.size(), -1);
    for (std::size_t k = 0; k < joining_points.size(); ++k)
      new_idx[static_cast<std::size_t>(joining_points[k])] = static_cast<int>(k);
    for (DeformingObservation seen : start.observations) {
      seen.point_idx = new_idx[static_cast<std::size_t>(seen.point_idx)];
      if (seen.point_idx >= 0 && seen.view_idx >= 4) joining.push_back(seen);
    }
    solution = SolveDeformingWindow(PartOf(start, known), kFocalPx, {});
    order = known;
    order.insert(order.end(), joining_points.begin(), joining_points.end());
  }

  Scene scene;
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
    EXPECT_LT((with->window.points_in_world[i] - alone->window.points_in_world[i]).norm(), kAgain_mm) << i;
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

// A window in the middle of things: coefficients, shapes and nodes of a solution, everything a little off.
struct Unsettled {
  DeformingWindow window;
  SurfaceNodes nodes;

  Unsettled() {
    const Scene scene(6);
    window = scene.Start(0.1);
    Random random(7);
    const auto noise = [&](Eigen::Index rows, Eigen::Index cols, double sigma) {
      return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return random.Normal(sigma); }).eval();
    };
    window.coefficients = noise(2, 6, 1.0);
    window.coefficients.col(0).setZero();
    for (std::size_t i = 0; i < window.points_in_world.size(); ++i) window.shapes.push_back(noise(3, 2, 0.2));
    nodes = NodesAt(window.points_in_world, {0, 20, 40, 60, 80, 100});
    nodes.shapes = noise(6, 6, 0.2);
  }
};

TEST(DeformingTerms, GradientsMatchDifferences) {
  const Unsettled start;
  const DeformingTerms terms(start.window, start.nodes, kFocalPx, {});
  DeformingState state = terms.Start();
  for (const std::size_t point : {std::size_t{3}, std::size_t{77}}) {
    const PointVector gradient = terms.Linearized(point, state, nullptr).gradient;
    for (Eigen::Index k = 0; k < gradient.size(); ++k) {
      double& value = state.points(k, static_cast<Eigen::Index>(point));
      const double kept = value;
      value = kept + kStep;
      const double after = terms.PointCost(point, state).value();
      value = kept - kStep;
      const double before = terms.PointCost(point, state).value();
      value = kept;
      EXPECT_NEAR((after - before) / (2 * kStep), gradient[k], kDifference * gradient.norm()) << point << " " << k;
    }
  }
}

// Where every point is at its best, the cost's gradient by the rest is the same whether the points follow or not.
TEST(DeformingEquations, SlopeMatchesDifferencesWhereThePointsAreSettled) {
  const Unsettled start;
  const DeformingTerms terms(start.window, start.nodes, kFocalPx, {});
  DeformingState state = terms.Start();
  for (std::size_t i = 0; i < terms.num_points(); ++i)
    for (int sweep = 0; sweep < 200; ++sweep) {
      const PointEquations equations = terms.Linearized(i, state, nullptr);
      auto column = state.points.col(static_cast<Eigen::Index>(i));
      const PointVector kept = column;
      const PointVector step = equations.own.llt().solve(equations.gradient);
      const double cost = terms.PointCost(i, state).value();
      for (double share = 1.0; share > 1e-6; share *= 0.5) {
        column = kept - share * step;
        if (const auto after = terms.PointCost(i, state); after && *after <= cost) break;
        column = kept;
      }
    }
  DeformingEquations all(terms, {});
  ViewEquations views(terms);
  for (NormalEquations* equations : std::initializer_list<NormalEquations*>{&all, &views}) {
    ASSERT_TRUE(equations->Linearize(terms.Start()));  // of which nothing may be left
    ASSERT_TRUE(equations->Linearize(state));
    Random random(5);
    for (int trial = 0; trial < 10; ++trial) {
      Eigen::VectorXd direction(equations->gradient().size());
      for (double& value : direction) value = random.Normal(1.0);
      const double after = terms.Cost(equations->Moved(state, kStep * direction)).value();
      const double before = terms.Cost(equations->Moved(state, -kStep * direction)).value();
      EXPECT_NEAR((after - before) / (2 * kStep), equations->gradient().dot(direction),
                  kDirectional * equations->gradient().norm() * direction.norm());
    }
  }
}

TEST(DeformingEquations, EliminatingThePointsChangesNoStep) {
  // The same equations, whole: by differences of the gradient they would be Newton's, so they are put together from the
  // points' and the views' shares here.
  const Unsettled start;
  const DeformingTerms terms(start.window, start.nodes, kFocalPx, {});
  const DeformingState state = terms.Start();
  DeformingEquations equations(terms, {});
  ASSERT_TRUE(equations.Linearize(state));
  const Eigen::VectorXd step = equations.NewtonStep();
  // A point's own row: own * dx + sum_v by_point' by_view dv + nodes + offset = - gradient.
  for (const std::size_t point : {std::size_t{3}, std::size_t{77}}) {
    std::vector<SeenEquations> seen;
    const PointEquations own = terms.Linearized(point, state, &seen);
    PointVector row = own.own * equations.PointStep(point, step);
    for (std::size_t k = 0; k < seen.size(); ++k)
      if (const int view = terms.seen(point)[k].view_idx; view > 0)
        row += seen[k].by_point.transpose() *
               (seen[k].by_view * step.segment((view - 1) * terms.view_size(), terms.view_size()));
    const Eigen::Index nodes_at = (terms.num_views() - 1) * terms.view_size();
    for (const NodeWeight& node : terms.nodes(point))
      row.tail(terms.shapes_size()) -=
          terms.node_information(point) * node.weight *
          step.segment(nodes_at + node.node_idx * terms.shapes_size(), terms.shapes_size());
    row[2] += own.by_offset * step[step.size() - 1];
    EXPECT_LT((row + own.gradient).norm(), kStepped * own.gradient.norm()) << point;
  }
}

TEST(DeformingWindow, TellsARigidSceneFromOneThatDeformsALittle) {
  Scene rigid;
  rigid.amplitude_mm = 0;
  Scene breathing;
  breathing.amplitude_mm = 0.3;
  const auto still = RigidResidualCorrelation(rigid.Start(0), kFocalPx, {});
  const auto moving = RigidResidualCorrelation(breathing.Start(0), kFocalPx, {});
  ASSERT_TRUE(still.ok() && moving.ok());
  EXPECT_LT(*still, kMaxOfNoise);
  EXPECT_GT(*moving, kMinOfMotion);
}

TEST(DeformingWindow, SolvesARigidSceneAsOne) {
  Scene scene;
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

TEST(SurfaceNodes, WeightsSumToOneAndANodesOwnPointIsItsAlone) {
  const Scene scene;
  const SurfaceNodes nodes = NodesAt(scene.points, {0, 20, 40, 60, 80, 100, 120});
  const std::vector<NodesOfPoint> around = NodesAround(scene.points, nodes.positions);
  for (const NodesOfPoint& of : around) {
    double sum = 0;
    for (const NodeWeight& weight : of.weights) sum += weight.weight;
    EXPECT_NEAR(sum, 1.0, kRounding);
    EXPECT_LE(of.weights.size(), kMaxNodes);
  }
  EXPECT_EQ(around[20].distance, 0.0);
  EXPECT_EQ(around[20].weights.front().node_idx, 1);
  // A linear field's gradient is found.
  SurfaceNodes linear = nodes;
  linear.shapes.resize(3, 7);
  for (Eigen::Index n = 0; n < 7; ++n) linear.shapes.col(n) = 0.5 * linear.positions[static_cast<std::size_t>(n)];
  EXPECT_NEAR(SizesOf(linear).gradient, 0.5 / std::sqrt(3.0), kRounding);
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
  EXPECT_LT(CompareWithLight(positions, light).error, kSameSurface);
  // A surface at the same rays that is another one does not fit.
  std::vector<Eigen::Vector3d> flat;
  for (const Eigen::Vector3d& position : positions) flat.push_back(50 * position.normalized());
  EXPECT_GT(CompareWithLight(flat, light).error, kOtherSurface);
  light.resize(10);
  positions.resize(10);
  EXPECT_EQ(CompareWithLight(positions, light).error, 0);
}

}  // namespace
}  // namespace pliant
