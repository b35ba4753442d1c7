// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// One solution of a deforming window (docs/method.md, eq. W2 to W7), and what can be said of it. Gauss and Newton's
// steps in a trust region, the points following each: several times as fast here as a general sparse solver.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "estimation/window/deforming_equations.h"
#include "estimation/window/deforming_terms.h"
#include "pliant/estimation/window/deforming_window.h"
#include "pliant/estimation/window/shape_basis.h"

namespace pliant {

// What a problem can be made of: kInvalidArgument for sizes, indices and numbers that are none, kInsufficient below
// three views or twelve points.
Status CheckWindow(const DeformingWindow& window);
Status CheckObservations(const std::vector<DeformingObservation>& observations, std::size_t views, std::size_t points);

class DeformingProblem {
 public:
  // `nodes` have shapes if the window has coefficients. The scale is held by some of the first `gauge_points` points
  // (W7).
  DeformingProblem(const DeformingWindow& start, const SurfaceNodes& nodes, double focal_px,
                   const DeformingWindowOptions& options,
                   std::size_t gauge_points = std::numeric_limits<std::size_t>::max());

  // The cost at the solution, what could not be measured included; kDegenerate when there is no finite start.
  // `threads` never changes the result.
  Result<double> Solve(int max_iterations, int threads = 1);
  // As Solve, for the views but the first and their coefficients; the points stay.
  Result<double> OptimizeViews(int max_iterations, int threads = 1);
  // As Solve, for the points and their shapes alone, each by itself; the rest stays and holds the scale.
  Result<double> OptimizePoints(int threads = 1);

  DeformingWindow Window() const { return terms_.Window(state_); }
  const Eigen::MatrixXd& NodeShapes() const { return state_.node_shapes; }

  // One a point, at the present values. See DeformingSolution.
  std::vector<double> LogDepthSigmas(int threads = 1) const;

 private:
  std::vector<int> GaugePoints(const DeformingWindow& start, std::size_t candidates) const;
  double GaugeMean(const DeformingState& state) const;
  void HoldScale(DeformingState* state) const;
  std::optional<double> StepPoint(std::size_t point, double cost, DeformingState* state) const;
  void FollowPoint(std::size_t point, const DeformingState& before, DeformingState* state) const;
  DeformingState Moved(const DeformingEquations& equations, const Eigen::VectorXd& step, int threads) const;
  using Move = std::function<DeformingState(const Eigen::VectorXd& step)>;
  Result<double> Descend(int max_iterations, NormalEquations* equations, const Move& moved);

  DeformingTerms terms_;
  DeformingState state_;
  std::vector<int> gauge_;  // points that hold the scale (W7)
  double gauge_mean_ = 0;
};

}  // namespace pliant
