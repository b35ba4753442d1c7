// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/window/deforming_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <Eigen/Cholesky>

#include "estimation/window/subspace_dogleg.h"
#include "estimation/window/view_equations.h"
#include "pliant/base/parallel.h"
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
  constexpr double kMaxLogDepth = 0.5;
  const double change = std::abs(step[2]);
  if (change <= kMaxLogDepth) return step;
  return kMaxLogDepth / change * step;
}

constexpr int kMinViews = 3;
constexpr int kMinPoints = 12;

Status NoStart() { return {ErrorCode::kDegenerate, "the deforming window has no finite cost at its start"}; }
Status NotDetermined() {
  return {ErrorCode::kDegenerate, "the rays of the deforming window do not determine its poses"};
}

}  // namespace

Status CheckWindow(const DeformingWindow& window) {
  const std::size_t views = window.cams_from_world.size();
  const std::size_t points = window.points_in_world.size();
  if (window.times.size() != views ||
      (window.coefficients.rows() > 0 && window.coefficients.cols() != static_cast<Eigen::Index>(views)) ||
      (window.coefficients.rows() > 0 && window.shapes.size() != points))
    return {ErrorCode::kInvalidArgument, "the parts of the deforming window differ in size"};
  if (static_cast<int>(views) < kMinViews || static_cast<int>(points) < kMinPoints)
    return {ErrorCode::kInsufficient, "a deforming window takes at least " + std::to_string(kMinViews) + " views and " +
                                          std::to_string(kMinPoints) + " points; there are " + std::to_string(views) +
                                          " and " + std::to_string(points)};
  const auto finite = [](const Eigen::Vector3d& vector) { return vector.allFinite(); };
  for (std::size_t v = 0; v < views; ++v)
    if (!std::isfinite(window.times[v]) || (v > 0 && !(window.times[v] > window.times[v - 1])))
      return {ErrorCode::kInvalidArgument, "the times of the deforming window's views have to grow; that of view " +
                                               std::to_string(v) + " does not"};
  if (!std::all_of(window.points_in_world.begin(), window.points_in_world.end(), finite))
    return {ErrorCode::kInvalidArgument, "a point of the deforming window is not a finite number"};
  return CheckObservations(window.observations, views, points);
}

Status CheckObservations(const std::vector<DeformingObservation>& observations, std::size_t views, std::size_t points) {
  for (const DeformingObservation& observation : observations)
    if (!observation.ray.allFinite() || observation.view_idx < 0 ||
        static_cast<std::size_t>(observation.view_idx) >= views || observation.point_idx < 0 ||
        static_cast<std::size_t>(observation.point_idx) >= points)
      return {ErrorCode::kInvalidArgument,
              "an observation of the window has no ray, or names a view or point that is not there"};
  return Status::Ok();
}

DeformingProblem::DeformingProblem(const DeformingWindow& start, const SurfaceNodes& nodes, double focal_px,
                                   const DeformingWindowOptions& options, std::size_t gauge_points)
    : terms_(start, nodes, focal_px, options), state_(terms_.Start()), gauge_(GaugePoints(start, gauge_points)) {
  gauge_mean_ = GaugeMean(state_);
}

std::vector<int> DeformingProblem::GaugePoints(const DeformingWindow& start, std::size_t candidates) const {
  std::vector<double> logs;
  for (std::size_t i = 0; i < std::min(candidates, start.points_in_world.size()); ++i)
    logs.push_back(std::log(start.points_in_world[i].norm()));
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
  state->points.bottomRows(terms_.shapes_size()) *= std::exp(change);
  state->node_shapes *= std::exp(change);
  for (ViewPose& pose : state->poses) pose.translation *= std::exp(change);
}

// One step of a point, everything else fixed, from where it is at `cost`: its lower cost then; nothing where no step
// lowers it.
std::optional<double> DeformingProblem::StepPoint(std::size_t point, double cost, DeformingState* state) const {
  auto column = state->points.col(static_cast<Eigen::Index>(point));
  const PointVector values = column;
  const PointEquations equations = terms_.Linearized(point, *state, nullptr);
  const PointVector step = Limited(equations.own.llt().solve(equations.gradient));
  for (const double share : {1.0, 0.5, 0.25}) {
    column = values - share * step;
    const auto after = terms_.PointCost(point, *state);
    if (after && *after < cost) return after;
  }
  column = values;
  return std::nullopt;
}

// One step of a point, from where it is or where it was before, whichever costs less.
void DeformingProblem::FollowPoint(std::size_t point, const DeformingState& before, DeformingState* state) const {
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
  if (cost) StepPoint(point, *cost, state);
}

// The points follow a step of the others: where the linear equations put them, then each by itself.
DeformingState DeformingProblem::Moved(const DeformingEquations& equations, const Eigen::VectorXd& step,
                                       int threads) const {
  DeformingState moved = equations.Moved(state_, step);
  ParallelFor(static_cast<int>(terms_.num_points()), threads, [&](int i) {
    const auto point = static_cast<std::size_t>(i);
    moved.points.col(i) += Limited(equations.PointStep(point, step));
    FollowPoint(point, state_, &moved);
  });
  HoldScale(&moved);
  return moved;
}

Result<double> DeformingProblem::Solve(int max_iterations, int threads) {
  DeformingEquations equations(terms_, gauge_, threads);
  return Descend(max_iterations, &equations,
                 [&](const Eigen::VectorXd& step) { return Moved(equations, step, threads); });
}

Result<double> DeformingProblem::OptimizeViews(int max_iterations, int threads) {
  ViewEquations equations(terms_, threads);
  return Descend(max_iterations, &equations,
                 [&](const Eigen::VectorXd& step) { return equations.Moved(state_, step); });
}

Result<double> DeformingProblem::Descend(int max_iterations, NormalEquations* equations, const Move& moved) {
  constexpr double kFirstRadius = 1e4;
  constexpr double kMinRadius = 1e-12;
  constexpr double kMinGain = 0.05;    // by what the linear model predicts: less is no step
  constexpr double kSmallGain = 0.25;  // a smaller region
  constexpr double kLargeGain = 0.75;  // a larger one
  auto cost = terms_.Cost(state_);
  if (!cost) return NoStart();
  double radius = kFirstRadius;
  bool done = false;
  for (int iteration = 0; iteration < max_iterations && !done; ++iteration) {
    if (!equations->Linearize(state_)) {
      if (iteration == 0) return NotDetermined();
      break;
    }
    const SubspaceDogleg dogleg(*equations);
    for (bool accepted = false; !accepted && !done;) {
      const SubspaceDogleg::Step best = dogleg.Best(radius);
      const double predicted = equations->eliminated_decrease() - best.change;
      const DeformingState candidate = moved(best.step);
      const auto candidate_cost = terms_.Cost(candidate);
      const double gain = candidate_cost && predicted > 0.0 ? (*cost - *candidate_cost) / predicted : -1.0;
      accepted = gain > kMinGain;
      if (accepted) {
        // A step that gave much less than was predicted was too long, and says nothing of the end.
        done = std::max(*cost - *candidate_cost, kSmallGain * predicted) < kTolerance * *cost;
        state_ = candidate;
        cost = candidate_cost;
        if (gain > kLargeGain) radius = std::max(radius, 3.0 * best.length);
        if (gain < kSmallGain) radius *= 0.5;
      } else {
        radius = 0.5 * std::min(radius, best.length);
        done = radius < kMinRadius || !(predicted > kTolerance * *cost);  // a smaller region promises less
      }
    }
  }
  return *cost + terms_.unmeasured_cost();
}

Result<double> DeformingProblem::OptimizePoints(int threads) {
  constexpr int kMaxSteps = 10;
  constexpr double kEnough = 10.0 * kTolerance;
  if (!terms_.Cost(state_)) return NoStart();
  ParallelFor(static_cast<int>(terms_.num_points()), threads, [&](int i) {
    const auto point = static_cast<std::size_t>(i);
    double cost = *terms_.PointCost(point, state_);
    for (int step = 0; step < kMaxSteps; ++step) {
      const auto after = StepPoint(point, cost, &state_);
      if (!after) break;
      const bool done = cost - *after < kEnough * cost;
      cost = *after;
      if (done) break;
    }
  });
  const auto cost = terms_.Cost(state_);
  if (!cost) return NoStart();
  return *cost + terms_.unmeasured_cost();
}

std::vector<double> DeformingProblem::LogDepthSigmas(int threads) const {
  DeformingEquations equations(terms_, gauge_, threads);
  if (!equations.Linearize(state_))
    return std::vector<double>(terms_.num_points(), std::numeric_limits<double>::infinity());
  std::vector<double> sigmas = equations.Variances();
  for (double& sigma : sigmas) sigma = std::sqrt(sigma);
  return sigmas;
}

}  // namespace pliant
