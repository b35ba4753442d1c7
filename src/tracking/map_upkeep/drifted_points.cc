// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/map_upkeep/drifted_points.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pliant/base/statistics.h"
#include "pliant/deformation/graph.h"

namespace pliant {
namespace {

constexpr int kMinTimesReestimated = 2;
constexpr int kNeighbors = 8;
constexpr double kSigmas = 3.0;

}  // namespace

std::vector<PointId> DriftedPoints(const std::vector<InitPosition>& reestimated, const Rigid3& cam_from_world,
                                   const Map& map, double max_change) {
  std::vector<PointId> ids;
  std::vector<Eigen::Vector3d> directions;
  std::vector<double> changes;
  for (const Landmark& landmark : map.landmarks) {
    const InitPosition* point = FindById(reestimated, landmark.id);
    if (point == nullptr || landmark.times_reestimated < kMinTimesReestimated) continue;
    const Eigen::Vector3d before = cam_from_world * landmark.position;
    ids.push_back(landmark.id);
    directions.push_back(before.normalized());
    changes.push_back(std::log((cam_from_world * point->position).norm() / before.norm()));
  }
  const NeighborLists neighbors = NearestNeighbors(directions, kNeighbors);
  std::vector<double> apart;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    std::vector<double> around;
    for (const int j : neighbors[i]) around.push_back(changes[static_cast<std::size_t>(j)]);
    apart.push_back(around.empty() ? 0.0 : std::abs(changes[i] - Median(std::move(around))));
  }
  if (apart.empty()) return {};
  const double bound = std::max(max_change, kSigmas * kMedianToSigma * Median(apart));
  std::vector<PointId> drifted;
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (apart[i] > bound) drifted.push_back(ids[i]);
  return drifted;
}

}  // namespace pliant
