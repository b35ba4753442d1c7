// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/map_upkeep/replace_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

// (W13) The map's unit in the outcome's; nothing when fewer than `min_common` of the `counted` points are in both.
std::optional<double> UnitOf(const InitFrameState& last, const Rigid3& cam_from_world, const Map& map,
                             const Map& counted, int min_common) {
  std::vector<double> ratios;
  for (const Landmark& landmark : map.landmarks)
    if (const InitPosition* point = FindById(last.positions, landmark.id);
        point != nullptr && counted.Find(landmark.id) != nullptr)
      ratios.push_back((cam_from_world * landmark.position).norm() / (last.cam_from_world * point->position).norm());
  if (static_cast<int>(ratios.size()) < min_common) return std::nullopt;
  return Median(std::move(ratios));
}

}  // namespace

bool ReplaceMap(const InitOutcome& outcome, const MapInFrame& then, Submap* submap,
                std::vector<RefinedPoint>* refined) {
  const InitFrameState& now = outcome.frames.back();
  const auto unit = UnitOf(now, then.cam_from_world, then.map, submap->map, 1);
  if (!unit) return false;
  const Rigid3 now_from_world(now.cam_from_world.rotation, *unit * now.cam_from_world.translation);
  submap->MoveInto(now_from_world.Inverse() * then.cam_from_world);
  const Map before = submap->map;
  for (Landmark& landmark : submap->map.landmarks) {
    if (const InitPosition* point = FindById(now.positions, landmark.id); point != nullptr) {
      const InitPoint* determined = FindById(outcome.points, landmark.id);
      landmark.position = *unit * point->position;
      landmark.rest_position = landmark.position;
      landmark.log_distance_sigma = determined != nullptr ? determined->LogDistanceSigma() : 0.0;
      landmark.determined_at = landmark.position;
    }
    landmark.last_motion.setZero();
    refined->push_back({landmark.id, landmark.rest_position});
  }
  for (const Landmark& lost : submap->lost_points.landmarks()) refined->push_back({lost.id, lost.rest_position});
  submap->candidates.TakeCorrection(before, submap->map);
  return true;
}

std::vector<InitPosition> ReestimatedPositions(const InitOutcome& outcome, const Rigid3& cam_from_world, const Map& map,
                                               int min_common) {
  const InitFrameState& now = outcome.frames.back();
  const auto unit = UnitOf(now, cam_from_world, map, map, min_common);
  if (!unit) return {};
  const Rigid3 world_from_cam = cam_from_world.Inverse();
  std::vector<InitPosition> positions;
  for (const InitPosition& point : now.positions)
    positions.push_back({point.id, world_from_cam * Eigen::Vector3d(*unit * (now.cam_from_world * point.position))});
  return positions;
}

std::vector<InitPosition> BringForward(const std::vector<InitPosition>& reestimated, const MapInFrame& then,
                                       const Camera& camera, const MapInFrame& now,
                                       const std::function<const Eigen::Vector2d*(PointId)>& pixel_of) {
  const Rigid3 world_from_cam = now.cam_from_world.Inverse();
  std::vector<InitPosition> positions;
  for (const InitPosition& point : reestimated) {
    const Landmark* before = then.map.Find(point.id);
    const Landmark* landmark = now.map.Find(point.id);
    if (before != nullptr && landmark != nullptr) {
      const double change =
          (then.cam_from_world * point.position).norm() / (then.cam_from_world * before->position).norm();
      positions.push_back(
          {point.id, world_from_cam * Eigen::Vector3d(change * (now.cam_from_world * landmark->position))});
    } else if (const Eigen::Vector2d* pixel = pixel_of(point.id); before == nullptr && landmark == nullptr && pixel) {
      if (const auto ray = camera.Unproject(*pixel))
        positions.push_back(
            {point.id, world_from_cam * Eigen::Vector3d((now.cam_from_world * point.position).norm() * *ray)});
    }
  }
  return positions;
}

void AverageWithBefore(const Rigid3& cam_from_world, const Map& map, double min_weight,
                       std::vector<InitPosition>* reestimated) {
  const Rigid3 world_from_cam = cam_from_world.Inverse();
  for (InitPosition& point : *reestimated) {
    const Landmark* landmark = map.Find(point.id);
    if (landmark == nullptr || landmark->times_reestimated < 2) continue;
    const double weight = std::max(min_weight, 1.0 / landmark->times_reestimated);
    const Eigen::Vector3d found = cam_from_world * point.position;
    const double ratio = (cam_from_world * landmark->position).norm() / found.norm();
    point.position = world_from_cam * Eigen::Vector3d(std::pow(ratio, 1.0 - weight) * found);
  }
}

}  // namespace pliant
