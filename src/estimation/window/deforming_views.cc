// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A solved window in other views and with more points.

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "estimation/window/deforming_problem.h"
#include "estimation/window/deforming_uncertainty.h"
#include "estimation/window/window_samples.h"
#include "pliant/base/statistics.h"
#include "pliant/estimation/window/deforming_window.h"
#include "pliant/estimation/window/shape_basis.h"

namespace pliant {
namespace {

// Views by which sigmas are found: more cost more and change little.
constexpr int kSigmaViews = 8;

// Where the points of a window are in one of its views, in that camera.
std::vector<Eigen::Vector3d> PositionsIn(const DeformingWindow& window, std::size_t points, int view_idx) {
  std::vector<Eigen::Vector3d> positions;
  for (std::size_t i = 0; i < points; ++i)
    positions.push_back(window.cams_from_world[static_cast<std::size_t>(view_idx)] *
                        window.Position(static_cast<int>(i), view_idx));
  return positions;
}

// A point at the weighted geometric mean distance of those near to its ray, with their shapes and their sample sigma.
void StartNear(const std::vector<NearPoint>& nearest, const std::vector<Eigen::Vector3d>& positions,
               const DeformingObservation& seen, std::size_t point, DeformingSolution* solution) {
  DeformingWindow& window = solution->window;
  double log_distance = 0;
  double sample_sigma = 0;
  Eigen::Matrix3Xd shapes = Eigen::Matrix3Xd::Zero(3, window.coefficients.rows());
  for (const NearPoint& near : nearest) {
    log_distance += near.weight * std::log(positions[near.idx].norm());
    if (!window.shapes.empty()) shapes += near.weight * window.shapes[near.idx];
    if (!solution->sample_sigmas.empty()) sample_sigma += near.weight * solution->sample_sigmas[near.idx];
  }
  window.points_in_world[point] =
      window.cams_from_world[static_cast<std::size_t>(seen.view_idx)].Inverse() * (std::exp(log_distance) * seen.ray) -
      shapes * window.coefficients.col(seen.view_idx);
  if (!window.shapes.empty()) window.shapes[point] = shapes;
  if (!solution->sample_sigmas.empty()) solution->sample_sigmas[point] = sample_sigma;
}

// The solution with the points that join after its own, at their start.
DeformingSolution WithJoining(const DeformingSolution& solution, const std::vector<DeformingObservation>& joining,
                              std::size_t num_joining) {
  DeformingSolution all = solution;
  DeformingWindow& window = all.window;
  const std::size_t known = window.points_in_world.size();
  window.points_in_world.resize(known + num_joining, window.MedianDistance() * Eigen::Vector3d::UnitZ());
  if (!window.shapes.empty())
    window.shapes.resize(known + num_joining, Eigen::Matrix3Xd::Zero(3, window.coefficients.rows()));
  if (!all.sample_sigmas.empty())
    all.sample_sigmas.resize(known + num_joining, std::numeric_limits<double>::infinity());
  std::vector<char> started(num_joining, 0);
  int view_idx = -1;
  std::vector<Eigen::Vector3d> positions;  // of the known points
  std::vector<Eigen::Vector3d> directions;
  for (DeformingObservation seen : joining) {
    if (seen.view_idx != view_idx) {
      view_idx = seen.view_idx;
      positions = PositionsIn(window, known, view_idx);
      directions = DirectionsOf(positions);
    }
    char& is_started = started[static_cast<std::size_t>(seen.point_idx)];
    seen.point_idx += static_cast<int>(known);
    window.observations.push_back(seen);
    if (is_started != 0) continue;
    is_started = 1;
    StartNear(NearestPoints(directions, seen.ray), positions, seen, static_cast<std::size_t>(seen.point_idx), &all);
  }
  return all;
}

}  // namespace

Result<DeformingWindow> OptimizeDeformingViews(const DeformingWindow& views, double focal_px,
                                               const DeformingWindowOptions& options, int threads) {
  if (Status status = CheckWindow(views); !status.ok()) return status;
  SurfaceNodes none = NodesAt(views.points_in_world, {0});
  none.shapes.setZero(3 * views.coefficients.rows(), 1);
  DeformingProblem problem(views, none, focal_px, options);
  if (const auto cost = problem.OptimizeViews(options.max_iterations, threads); !cost.ok()) return cost.status();
  return problem.Window();
}

Result<DeformingSolution> OptimizeDeformingPoints(const DeformingSolution& solution,
                                                  const std::vector<DeformingObservation>& joining, int num_joining,
                                                  double focal_px, const DeformingWindowOptions& options, int threads) {
  if (Status status = CheckWindow(solution.window); !status.ok()) return status;
  if (Status status = CheckObservations(joining, solution.window.times.size(), static_cast<std::size_t>(num_joining));
      !status.ok())
    return status;
  DeformingSolution optimized = WithJoining(solution, joining, static_cast<std::size_t>(num_joining));
  DeformingProblem problem(optimized.window, optimized.nodes, focal_px, options);
  const auto cost = problem.OptimizePoints(threads);
  if (!cost.ok()) return cost.status();
  optimized.cost = *cost;
  optimized.window = problem.Window();
  // So many frames leave a point little to adapt to their noise with.
  const double noise_px = Median(PointErrorsPx(optimized.window, focal_px));
  DeformingSolution some;
  some.window = InSomeViews(optimized.window, kSigmaViews);
  some.nodes = optimized.nodes;
  optimized.log_depth_sigmas =
      FoundLogDepthSigmas(some, noise_px, solution.window.points_in_world.size(), focal_px, options, threads);
  return optimized;
}

}  // namespace pliant
