// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/window/window_samples.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "pliant/estimation/window/shape_basis.h"
#include "pliant/estimation/window/window_refinement.h"

namespace pliant {
namespace {

constexpr std::size_t kMinSample = 60;
constexpr std::size_t kNearestDirections = 4;
constexpr double kSameDirection = 1e-3;  // rad, below which nearer does not count for more

using Directions = std::vector<Eigen::Vector3d>;

PointSample AllOf(const Directions& directions) {
  PointSample all(directions.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

}  // namespace

std::vector<Eigen::Vector3d> DirectionsOf(const std::vector<Eigen::Vector3d>& positions) {
  std::vector<Eigen::Vector3d> directions;
  for (const Eigen::Vector3d& position : positions) directions.push_back(position.normalized());
  return directions;
}

std::vector<NearPoint> NearestPoints(const std::vector<Eigen::Vector3d>& directions, const Eigen::Vector3d& direction) {
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t k = 0; k < directions.size(); ++k) near.emplace_back((directions[k] - direction).norm(), k);
  const std::size_t count = std::min(kNearestDirections, near.size());
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
  std::vector<NearPoint> nearest;
  double sum = 0;
  for (std::size_t n = 0; n < count; ++n) {
    nearest.push_back({near[n].second, 1.0 / (near[n].first + kSameDirection)});
    sum += nearest.back().weight;
  }
  for (NearPoint& point : nearest) point.weight /= sum;
  return nearest;
}

DeformingWindow InSomeViews(const DeformingWindow& window, int count) {
  if (window.times.size() <= static_cast<std::size_t>(count)) return window;
  DeformingWindow some = window;
  some.times.clear();
  some.cams_from_world.clear();
  some.coefficients.resize(window.coefficients.rows(), count);
  some.observations.clear();
  std::vector<int> new_idx(window.times.size(), -1);
  for (const std::size_t view : SpreadViews(window.times.size(), static_cast<std::size_t>(count))) {
    const auto k = static_cast<int>(some.times.size());
    new_idx[view] = k;
    some.times.push_back(window.times[view]);
    some.cams_from_world.push_back(window.cams_from_world[view]);
    some.coefficients.col(k) = window.coefficients.col(static_cast<Eigen::Index>(view));
  }
  for (DeformingObservation observation : window.observations) {
    observation.view_idx = new_idx[static_cast<std::size_t>(observation.view_idx)];
    if (observation.view_idx >= 0) some.observations.push_back(observation);
  }
  return some;
}

PointSample SpreadPoints(const std::vector<Eigen::Vector3d>& points_in_world, int count) {
  const Directions directions = DirectionsOf(points_in_world);
  return SpreadPositions(directions, AllOf(directions), static_cast<std::size_t>(count));
}

std::vector<PointSample> SamplePoints(const DeformingWindow& window, int size) {
  const Directions directions = DirectionsOf(window.points_in_world);
  const PointSample all = AllOf(directions);
  const std::size_t count = std::min(static_cast<std::size_t>(size), all.size() / 2);
  if (count < kMinSample) return {all};
  PointSample first = SpreadPositions(directions, all, count);
  PointSample others;
  std::set_difference(all.begin(), all.end(), first.begin(), first.end(), std::back_inserter(others));
  PointSample second = SpreadPositions(directions, others, count);
  return {std::move(first), std::move(second)};
}

DeformingWindow PartOf(const DeformingWindow& window, const PointSample& sample) {
  DeformingWindow part;
  part.times = window.times;
  part.cams_from_world = window.cams_from_world;
  part.camera = window.camera;
  part.cue = window.cue;
  std::vector<int> index(window.points_in_world.size(), -1);
  for (const int i : sample) {
    index[static_cast<std::size_t>(i)] = static_cast<int>(part.points_in_world.size());
    part.points_in_world.push_back(window.points_in_world[static_cast<std::size_t>(i)]);
  }
  for (DeformingObservation observation : window.observations) {
    observation.point_idx = index[static_cast<std::size_t>(observation.point_idx)];
    if (observation.point_idx >= 0) part.observations.push_back(observation);
  }
  return part;
}

DeformingWindow ExtendToAll(const DeformingWindow& start, const DeformingWindow& part, const PointSample& sample) {
  DeformingWindow all = start;
  all.cams_from_world = part.cams_from_world;
  all.coefficients = part.coefficients;
  all.shapes.clear();
  Directions sampled;
  for (const int i : sample) sampled.push_back(start.points_in_world[static_cast<std::size_t>(i)].normalized());
  std::vector<double> changes;  // of log distance
  for (std::size_t k = 0; k < sample.size(); ++k)
    changes.push_back(
        std::log(part.points_in_world[k].norm() / start.points_in_world[static_cast<std::size_t>(sample[k])].norm()));
  for (Eigen::Vector3d& position : all.points_in_world) {
    double change = 0;
    Eigen::Matrix3Xd shapes = Eigen::Matrix3Xd::Zero(3, part.coefficients.rows());
    for (const NearPoint& near : NearestPoints(sampled, position.normalized())) {
      change += near.weight * changes[near.idx];
      shapes += near.weight * part.shapes[near.idx];
    }
    position *= std::exp(change);
    all.shapes.push_back(std::move(shapes));
  }
  for (std::size_t k = 0; k < sample.size(); ++k) {
    all.points_in_world[static_cast<std::size_t>(sample[k])] = part.points_in_world[k];
    all.shapes[static_cast<std::size_t>(sample[k])] = part.shapes[k];
  }
  return all;
}

}  // namespace pliant
