// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/window/deforming_equations.h"

#include <vector>

#include <gtest/gtest.h>

#include "estimation/deforming_scene.h"
#include "estimation/window/deforming_terms.h"
#include "estimation/window/view_equations.h"
#include "pliant/base/random.h"
#include "pliant/estimation/window/shape_basis.h"

namespace pliant {
namespace {

using deforming_test::DeformingScene;
using deforming_test::kFocalPx;

constexpr double kDifference = 1e-5;  // of central differences with kStateStep, relative to entries of up to 1e3
constexpr double kStateStep = 1e-6;
constexpr double kDirectional = 1e-4;  // relative to both lengths; kDifference, times a cosine that may be small
constexpr double kStepped = 1e-5;      // relative; the step solves the equations to the solver's precision

// A window as in the middle of a solution: temporal coefficients, basis shapes and nodes, everything a little off.
struct PerturbedWindow {
  DeformingWindow window;
  SurfaceNodes nodes;

  PerturbedWindow() {
    const DeformingScene scene(6);
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
  const PerturbedWindow start;
  const DeformingTerms terms(start.window, start.nodes, kFocalPx, {});
  DeformingState state = terms.Start();
  for (const std::size_t point : {std::size_t{3}, std::size_t{77}}) {
    const PointVector gradient = terms.Linearized(point, state, nullptr).gradient;
    for (Eigen::Index k = 0; k < gradient.size(); ++k) {
      double& value = state.points(k, static_cast<Eigen::Index>(point));
      const double kept = value;
      value = kept + kStateStep;
      const double after = terms.PointCost(point, state).value();
      value = kept - kStateStep;
      const double before = terms.PointCost(point, state).value();
      value = kept;
      EXPECT_NEAR((after - before) / (2 * kStateStep), gradient[k], kDifference * gradient.norm()) << point << " " << k;
    }
  }
}

// Where every point is at its best, the cost's gradient by the rest is the same whether the points follow or not.
TEST(DeformingEquations, GradientMatchesDifferencesWhereThePointsAreOptimized) {
  const PerturbedWindow start;
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
      const double after = terms.Cost(equations->Moved(state, kStateStep * direction)).value();
      const double before = terms.Cost(equations->Moved(state, -kStateStep * direction)).value();
      EXPECT_NEAR((after - before) / (2 * kStateStep), equations->gradient().dot(direction),
                  kDirectional * equations->gradient().norm() * direction.norm());
    }
  }
}

TEST(DeformingEquations, EliminatingThePointsChangesNoStep) {
  // The same equations, whole: by differences of the gradient they would be Newton's, so they are put together from the
  // points' and the views' shares here.
  const PerturbedWindow start;
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

}  // namespace
}  // namespace pliant
