// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/bootstrapping/rigid_map.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "tracking/bootstrapping/initial_map.h"

namespace pliant {
namespace {

Status Invalid(std::string what) { return {ErrorCode::kInvalidArgument, std::move(what)}; }

Status CheckPoints(const std::vector<RigidMap::Point>& sorted, const std::set<PointId>& followed) {
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const RigidMap::Point& point = sorted[i];
    const std::string name = "point " + std::to_string(point.id.value);
    if (i > 0 && point.id == sorted[i - 1].id) return Invalid(name + " is in the map twice");
    if (!followed.contains(point.id)) return Invalid(name + " of the map is in none of the frames");
    if (!point.position.allFinite() || !std::isfinite(point.depth_sigma) || point.depth_sigma < 0)
      return Invalid("position and sigma of " + name +
                     " have to be finite numbers, sigma at least 0; leave points out that are not known");
  }
  return Status::Ok();
}

Status CheckPoses(const std::vector<std::optional<Rigid3>>& cams_from_world, std::size_t frames) {
  constexpr double kSame = 1e-6;  // of single precision
  if (cams_from_world.size() != frames)
    return Invalid("a map has " + std::to_string(cams_from_world.size()) + " poses, and there are " +
                   std::to_string(frames) + " frames since the reference");
  if (!cams_from_world.front() || !cams_from_world.back())
    return Invalid("the poses of the reference and of the present frame have to be known");
  for (const std::optional<Rigid3>& pose : cams_from_world)
    if (pose && !(pose->RotationMatrix().allFinite() && pose->translation.allFinite()))
      return Invalid("a pose of the map is not a finite number");
  const Rigid3& first = *cams_from_world.front();
  if (!first.RotationMatrix().isIdentity(kSame) || first.translation.norm() > kSame)
    return Invalid("the first pose has to be the identity: the world is the camera of the reference");
  return Status::Ok();
}

}  // namespace

Status FillRigidMap(const InitInput& input, const RigidMap& map, int min_points, double nominal_depth_mm,
                    InitOutcome* outcome) {
  std::set<PointId> others;  // at first all that are followed
  for (const InitFrame& frame : input.frames)
    for (const InitObservation& seen : frame.observations) others.insert(seen.id);
  std::vector<RigidMap::Point> points = map.points;
  std::ranges::sort(points, {}, &RigidMap::Point::id);
  if (Status status = CheckPoints(points, others); !status.ok()) return status;
  if (Status status = CheckPoses(map.cams_from_world, input.frames.size()); !status.ok()) return status;

  InitialMap initial;
  for (const RigidMap::Point& point : points) {
    initial.ids.push_back(point.id);
    initial.positions.push_back(point.position);
    initial.depth_sigmas.push_back(point.depth_sigma);
    initial.parallaxes_rad.push_back(0.0);
    others.erase(point.id);
  }
  const auto seen = std::ranges::count_if(input.frames.back().observations, [&](const InitObservation& observation) {
    return std::ranges::binary_search(initial.ids, observation.id);
  });
  if (seen < min_points)
    return {ErrorCode::kInsufficient, "only " + std::to_string(seen) +
                                          " points of the map are still followed, of at least " +
                                          std::to_string(min_points)};
  std::vector<KnownPose> known;
  for (const auto& pose : map.cams_from_world) known.push_back({pose.has_value(), pose.value_or(Rigid3())});
  const auto cams_from_world = EstimateFramePoses(input, initial, std::move(known), {});
  if (!cams_from_world.ok()) return cams_from_world.status();
  std::vector<InitRejectedPoint> rejected;
  for (const PointId id : others) rejected.push_back({id, InitRejection::kUncertainDepth});
  return FillRigidMap(input, initial, *cams_from_world, std::move(rejected), nominal_depth_mm, outcome);
}

}  // namespace pliant
