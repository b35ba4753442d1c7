// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What a deforming window leaves unexplained.
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "estimation/ray_residuals.h"
#include "estimation/window/window_samples.h"
#include "pliant/base/statistics.h"
#include "pliant/deformation/graph.h"
#include "pliant/estimation/window/deforming_window.h"
#include "pliant/geometry/triangulation.h"

namespace pliant {
namespace {

// Errors larger than this many times the median one count as that large: wrong tracks are like nobody.
constexpr double kLargestError = 4.0;
constexpr int kNeighbors = 4;

}  // namespace

std::vector<double> PointErrorsPx(const DeformingWindow& window, double focal_px) {
  std::vector<double> sums(window.points_in_world.size(), 0.0);
  std::vector<int> counts(sums.size(), 0);
  for (const DeformingObservation& observation : window.observations) {
    if (observation.view_idx == 0) continue;
    const auto i = static_cast<std::size_t>(observation.point_idx);
    const Eigen::Vector3d x = window.cams_from_world[static_cast<std::size_t>(observation.view_idx)] *
                              window.Position(observation.point_idx, observation.view_idx);
    sums[i] += std::pow(focal_px * AngleBetween(x, observation.ray), 2);
    ++counts[i];
  }
  for (std::size_t i = 0; i < sums.size(); ++i)
    sums[i] = counts[i] > 0 ? std::sqrt(sums[i] / counts[i]) : std::numeric_limits<double>::infinity();
  return sums;
}

NeighborErrors ErrorsOfNeighbors(const DeformingWindow& window, const std::vector<int>& view_idxs,
                                 double min_angle_rad) {
  const auto points = window.points_in_world.size();
  const Eigen::Vector2d none = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  std::vector<std::vector<Eigen::Vector2d>> errors(window.cams_from_world.size());
  for (const int v : view_idxs) errors[static_cast<std::size_t>(v)].assign(points, none);
  std::vector<double> sizes;
  for (const DeformingObservation& observation : window.observations) {
    const auto v = static_cast<std::size_t>(observation.view_idx);
    if (errors[v].empty()) continue;
    const Eigen::Vector3d x = window.cams_from_world[v] * window.Position(observation.point_idx, observation.view_idx);
    // In the camera's own axes, so that neighbors' errors can be compared.
    const Eigen::Vector2d error = (x.normalized() - observation.ray).head<2>();
    errors[v][static_cast<std::size_t>(observation.point_idx)] = error;
    sizes.push_back(error.norm());
  }
  if (sizes.empty()) return {};
  const double largest = kLargestError * Median(std::move(sizes));
  for (auto& of_view : errors)
    for (Eigen::Vector2d& error : of_view)
      if (error.norm() > largest) error *= largest / error.norm();

  const double min_chord = 2.0 * std::sin(0.5 * min_angle_rad);
  const NeighborLists neighbors = NearestNeighborsApart(DirectionsOf(window.points_in_world), min_chord, kNeighbors);
  NeighborErrors sums;
  double pairs = 0;
  for (const auto& of_view : errors)
    for (std::size_t i = 0; i < of_view.size(); ++i)
      for (const int j : neighbors[i]) {
        const Eigen::Vector2d& a = of_view[i];
        const Eigen::Vector2d& b = of_view[static_cast<std::size_t>(j)];
        if (!a.allFinite() || !b.allFinite()) continue;
        sums.shared += a.dot(b);
        sums.all += 0.5 * (a.squaredNorm() + b.squaredNorm());
        ++pairs;
      }
  if (pairs == 0) return {};
  return {sums.shared / pairs, sums.all / pairs, std::sqrt(static_cast<double>(view_idxs.size()) / pairs)};
}

double ResidualCorrelation(const DeformingWindow& window, double min_angle_rad) {
  std::vector<int> views(window.cams_from_world.size());
  std::iota(views.begin(), views.end(), 0);
  return ErrorsOfNeighbors(window, views, min_angle_rad).Correlation();
}

}  // namespace pliant
