// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/deforming_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "estimation/trust_plane.h"
#include "pliant/base/statistics.h"

namespace pliant {
namespace {

// The scale is held by some points alone, spread over the nearer ones.
constexpr std::size_t kGaugePoints = 32;
constexpr double kGaugeReach = 0.5;  // log distance beyond the median up to which a point may hold the scale
// A solution is found when a step changes the cost by less than this share.
constexpr double kTolerance = 1e-4;

// A point's step, shorter where its depth would change by too much at once.
PointVector Limited(const PointVector& step) {
  constexpr double kMostLogDepth = 0.5;
  const double change = std::abs(step[2]);
  if (change <= kMostLogDepth) return step;
  return kMostLogDepth / change * step;
}

Status NoStart() { return {ErrorCode::kDegenerate, "the deforming window has no finite cost at its start"}; }

}  // namespace

DeformingProblem::DeformingProblem(const DeformingWindow& start, const SurfaceNodes& nodes, double focal_px,
                                   const DeformingWindowOptions& options)
    : terms_(start, nodes, focal_px, options), state_(terms_.Start()), gauge_(GaugePoints(start)) {
  gauge_mean_ = GaugeMean(state_);
}

std::vector<int> DeformingProblem::GaugePoints(const DeformingWindow& start) const {
  std::vector<double> logs;
  for (const Eigen::Vector3d& position : start.points_in_world) logs.push_back(std::log(position.norm()));
  const double farthest = Median(logs) + kGaugeReach;
  std::vector<int> near;
  for (std::size_t i = 0; i < logs.size(); ++i)
    if (logs[i] < farthest) near.push_back(static_cast<int>(i));
  const std::size_t stride = std::max<std::size_t>(1, near.size() / kGaugePoints);
  std::vector<int> chosen;
  for (std::size_t k = 0; k < near.size(); k += stride) chosen.push_back(near[k]);
  return chosen;
}

double DeformingProblem::GaugeMean(const DeformingState& state) const {
  double sum = 0;
  for (const int i : gauge_) sum += state.points(2, i);
  return sum / static_cast<double>(gauge_.size());
}

// (W7) All of the scene in another scale, so that the mean log distance of the points of the gauge is as at the start.
void DeformingProblem::HoldScale(DeformingState* state) const {
  const double change = gauge_mean_ - GaugeMean(*state);
  state->points.row(2).array() += change;
  state->light_offset += change;
  state->points.bottomRows(terms_.modes_size()) *= std::exp(change);
  state->node_modes *= std::exp(change);
  for (Rigid3& pose : state->cams_from_world) pose.translation *= std::exp(change);
}

// A point by itself, everything else held: from where it is or where it was before, whichever is better, one step.
void DeformingProblem::Settle(std::size_t point, const DeformingState& before, DeformingState* state) const {
  auto column = state->points.col(static_cast<Eigen::Index>(point));
  PointVector values = column;
  auto cost = terms_.PointCost(point, *state);
  column = before.points.col(static_cast<Eigen::Index>(point));
  const auto cost_before = terms_.PointCost(point, *state);
  if (cost_before && (!cost || *cost_before < *cost)) {
    values = column;
    cost = cost_before;
  }
  column = values;
  if (!cost) return;
  const PointEquations equations = terms_.Linearised(point, *state, nullptr);
  const PointVector step = Limited(equations.own.llt().solve(equations.gradient));
  for (const double share : {1.0, 0.5, 0.25}) {
    column = values - share * step;
    const auto after = terms_.PointCost(point, *state);
    if (after && *after < *cost) return;
  }
  column = values;
}

// The points follow a step of the others: where the linear equations put them, then each by itself.
DeformingState DeformingProblem::Moved(const DeformingEquations& equations, const Eigen::VectorXd& step,
                                       FreeParts free) const {
  DeformingState moved = equations.Moved(state_, step);
  if (free != FreeParts::kAll) return moved;
  const Eigen::MatrixXd steps = equations.PointSteps(step);
  for (std::size_t i = 0; i < terms_.num_points(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    moved.points.col(column) += Limited(steps.col(column));
    Settle(i, state_, &moved);
  }
  HoldScale(&moved);
  return moved;
}

Result<double> DeformingProblem::Solve(int max_iterations, FreeParts free) {
  constexpr double kFirstRadius = 1e4;
  constexpr double kLeastRadius = 1e-12;
  constexpr double kLeastGain = 0.05;  // by what the linear model predicts: less is no step
  constexpr double kSmallGain = 0.25;  // a smaller region
  constexpr double kLargeGain = 0.75;  // a larger one
  constexpr double kNoPromise = 1e-3 * kTolerance;
  auto cost = terms_.Cost(state_);
  if (!cost) return NoStart();
  const std::vector<int> gauge = free == FreeParts::kAll ? gauge_ : std::vector<int>();
  double radius = kFirstRadius;
  bool done = false;
  for (int iteration = 0; iteration < max_iterations && !done; ++iteration) {
    const auto equations = DeformingEquations::At(terms_, state_, free, gauge);
    if (!equations) break;
    const TrustPlane plane(*equations);
    for (bool accepted = false; !accepted && !done;) {
      const TrustPlane::Step best = plane.Best(radius);
      const double predicted = equations->settled() - best.change;
      const DeformingState candidate = Moved(*equations, best.step, free);
      const auto candidate_cost = terms_.Cost(candidate);
      const double gain = candidate_cost && predicted > 0.0 ? (*cost - *candidate_cost) / predicted : -1.0;
      accepted = gain > kLeastGain;
      if (accepted) {
        // A step that gave much less than was predicted was too long, and says nothing of the end.
        done = std::max(*cost - *candidate_cost, kSmallGain * predicted) < kTolerance * *cost;
        state_ = candidate;
        cost = candidate_cost;
        if (gain > kLargeGain) radius = std::max(radius, 3.0 * best.length);
        if (gain < kSmallGain) radius *= 0.5;
      } else {
        radius = 0.5 * std::min(radius, best.length);
        done = radius < kLeastRadius || !(predicted > kNoPromise * *cost);
      }
    }
  }
  return *cost + terms_.unmeasured_cost();
}

Result<double> DeformingProblem::SettlePoints() {
  constexpr int kMostSweeps = 10;
  constexpr double kEnough = 10.0 * kTolerance;
  auto cost = terms_.Cost(state_);
  if (!cost) return NoStart();
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    for (std::size_t i = 0; i < terms_.num_points(); ++i) Settle(i, state_, &state_);
    const auto after = terms_.Cost(state_);
    const bool done = !after || *cost - *after < kEnough * *cost;
    if (after) cost = after;
    if (done) break;
  }
  return *cost + terms_.unmeasured_cost();
}

std::vector<double> DeformingProblem::LogDepthSigmas() const {
  const auto equations = DeformingEquations::At(terms_, state_, FreeParts::kAll, gauge_);
  if (!equations) return std::vector<double>(terms_.num_points(), std::numeric_limits<double>::infinity());
  std::vector<double> sigmas = equations->Variances();
  for (double& sigma : sigmas) sigma = std::sqrt(sigma);
  return sigmas;
}

}  // namespace pliant
