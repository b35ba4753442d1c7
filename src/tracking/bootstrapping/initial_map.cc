// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/bootstrapping/initial_map.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "pliant/base/options.h"
#include "pliant/base/statistics.h"
#include "pliant/geometry/triangulation.h"
#include "pliant/scene/map.h"

namespace pliant {
namespace {

constexpr double kWideLossPx = 10.0;  // frames may lie tens of pixels apart

Result<Rigid3> EstimateOnce(const Camera& camera, const InitFrame& frame, const InitialMap& map, const Rigid3& near,
                            const RefinementOptions& options) {
  constexpr std::size_t kMinSeen = 6;
  Window window;
  window.cams_from_world = {Rigid3(), near};
  window.points_in_world = map.positions;
  window.observations = ObservationsOf(camera, frame, map.ids, 1);
  if (window.observations.size() < kMinSeen)
    return Status(ErrorCode::kInsufficient, "frame " + std::to_string(frame.frame_idx) + " sees only " +
                                                std::to_string(window.observations.size()) + " points of the map");
  const auto optimized = RefineWindow(window, camera.MeanFocalLengthPx(), WindowPoints::kFixed, options);
  if (!optimized.ok()) return optimized.status();
  return optimized->window.cams_from_world.back();
}

}  // namespace

MatchedRays MatchRays(const Camera& camera, const InitFrame& reference, const InitFrame& current) {
  MatchedRays matched;
  auto now = current.observations.begin();
  for (const InitObservation& observation : reference.observations) {
    while (now != current.observations.end() && now->id < observation.id) ++now;
    if (now == current.observations.end() || now->id != observation.id) {
      matched.rejected.push_back({observation.id, InitRejection::kLostOnTheWay});
      continue;
    }
    const auto ray0 = camera.Unproject(observation.pixel);
    const auto ray1 = camera.Unproject(now->pixel);
    if (!ray0 || !ray1 || !ray0->allFinite() || !ray1->allFinite()) {
      matched.rejected.push_back({observation.id, InitRejection::kNoRay});
      continue;
    }
    matched.ids.push_back(observation.id);
    matched.rays0.push_back(*ray0);
    matched.rays1.push_back(*ray1);
  }
  return matched;
}

Result<RelativePose> EstimateMotion(const MatchedRays& matched, double focal_px, const MonocularInitOptions& options,
                                    Random random) {
  auto pose = EstimateRelativePose(matched.rays0, matched.rays1, focal_px, random.Child("relative_pose"),
                                   {.solver = options.solver,
                                    .robust = options.robust,
                                    .max_error_px = options.max_error_px,
                                    .max_iterations = options.max_iterations});
  if (pose.ok() && pose->cam1_from_cam0.translation.isZero(0.0))
    return Status(ErrorCode::kDegenerate, "a rotation (Init.solver = " + std::string(EnumName(options.solver)) +
                                              ") determines no depth: this solver is for comparison only");
  return pose;
}

InitialMap TriangulateInliers(const Rigid3& cam1_from_cam0, const std::vector<char>& inliers, double focal_px,
                              const MonocularInitOptions& options, MatchedRays* matched) {
  InitialMap map;
  const auto points = Triangulate(options.triangulation, cam1_from_cam0, matched->rays0, matched->rays1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (inliers[i] == 0 || !points[i].ok()) {
      matched->rejected.push_back(
          {matched->ids[i], inliers[i] == 0 ? InitRejection::kEpipolar : InitRejection::kCheirality});
      continue;
    }
    const double parallax = ParallaxAngle(cam1_from_cam0.rotation, matched->rays0[i], matched->rays1[i]);
    map.ids.push_back(matched->ids[i]);
    map.positions.push_back(points[i].point_in_cam0);
    map.parallaxes_rad.push_back(parallax);
    map.depth_sigmas.push_back(points[i].point_in_cam0.norm() *
                               RelativeDepthSigma(options.sigma_px, focal_px, parallax));
  }
  return map;
}

std::vector<WindowObservation> ObservationsOf(const Camera& camera, const InitFrame& frame,
                                              const std::vector<PointId>& ids, int view_idx) {
  std::vector<WindowObservation> observations;
  auto seen = frame.observations.begin();
  for (std::size_t i = 0; i < ids.size(); ++i) {
    while (seen != frame.observations.end() && seen->id < ids[i]) ++seen;
    if (seen == frame.observations.end()) break;
    if (seen->id != ids[i]) continue;
    const auto ray = camera.Unproject(seen->pixel);
    if (ray && ray->allFinite()) observations.push_back({view_idx, static_cast<int>(i), *ray});
  }
  return observations;
}

Result<Rigid3> EstimateFramePoseRoughly(const Camera& camera, const InitFrame& frame, const InitialMap& map,
                                        const Rigid3& near) {
  constexpr int kFewIterations = 5;
  return EstimateOnce(camera, frame, map, near, {.loss_scale_px = kWideLossPx, .max_iterations = kFewIterations});
}

Result<Rigid3> EstimateFramePose(const Camera& camera, const InitFrame& frame, const InitialMap& map,
                                 const Rigid3& near, const RefinementOptions& options) {
  RefinementOptions wide = options;
  wide.loss_scale_px = kWideLossPx;
  const auto optimized = EstimateOnce(camera, frame, map, near, wide);
  if (!optimized.ok()) return optimized.status();
  return EstimateOnce(camera, frame, map, *optimized, options);
}

Result<std::vector<Rigid3>> EstimateFramePoses(const InitInput& input, const InitialMap& map,
                                               std::vector<KnownPose> known, const RefinementOptions& options) {
  std::vector<Rigid3> poses(known.size());
  poses.back() = known.back().cam_from_world;
  for (std::size_t k = known.size() - 1; k-- > 0;) {
    if (known[k].known) {
      poses[k] = known[k].cam_from_world;
      continue;
    }
    const auto pose = EstimateFramePose(input.camera, input.frames[k], map, poses[k + 1], options);
    if (!pose.ok()) return pose.status();
    poses[k] = *pose;
  }
  return poses;
}

void FillRigidFrames(const InitInput& input, const std::vector<Rigid3>& cams_from_world, InitOutcome* outcome) {
  assert(cams_from_world.size() == input.frames.size());
  for (std::size_t k = 0; k < cams_from_world.size(); ++k) {
    const InitFrame& frame = input.frames[k];
    InitFrameState state{frame.frame_idx, cams_from_world[k], {}};
    auto seen = frame.observations.begin();
    for (const InitPoint& point : outcome->points) {
      while (seen != frame.observations.end() && seen->id < point.id) ++seen;
      if (seen == frame.observations.end()) break;
      if (seen->id == point.id) state.positions.push_back({point.id, point.position});
    }
    outcome->frames.push_back(std::move(state));
  }
}

void BackProjectDepths(const InitInput& input, const std::vector<std::optional<double>>& depths, InitOutcome* outcome) {
  const std::vector<InitObservation>& observations = input.frames.front().observations;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const auto ray = input.camera.Unproject(observations[i].pixel);
    if (!ray || ray->z() <= 0)
      outcome->rejected.push_back({observations[i].id, InitRejection::kNoRay});
    else if (!depths[i])
      outcome->rejected.push_back({observations[i].id, InitRejection::kUncertainDepth});
    else
      outcome->points.push_back({observations[i].id, *ray * (*depths[i] / ray->z()), 0.0, 0.0});
  }
  outcome->measured.correspondences = static_cast<int>(observations.size());
  outcome->measured.inliers = static_cast<int>(outcome->points.size());
}

void FillKnownMap(const InitInput& input, std::string_view source, InitOutcome* outcome) {
  std::vector<double> depths_mm;
  for (const InitPoint& point : outcome->points) depths_mm.push_back(point.position.z());
  if (const double median_mm = Median(std::move(depths_mm)); median_mm < kMinHeldDistance_mm) {
    outcome->decision = InitDecision::kNewReference;
    outcome->reason = "the points are " + FormatDouble(median_mm) +
                      " mm from the camera, in the median, and the files of a run hold " +
                      FormatDouble(kMinHeldDistance_mm) +
                      " mm and more: check the unit (Init.model_unit_mm, depth_scale or the baseline)";
    outcome->points.clear();
    return;
  }
  outcome->decision = InitDecision::kMap;
  outcome->reason = "first map of " + std::to_string(outcome->points.size()) + " points from " + std::string(source);
  FillRigidFrames(input, {Rigid3()}, outcome);
}

Result<double> NominalScale(const std::vector<Eigen::Vector3d>& positions, double nominal_depth_mm) {
  std::vector<double> depths;
  for (const Eigen::Vector3d& position : positions) depths.push_back(position.z());
  const double median = depths.empty() ? 0.0 : Median(std::move(depths));
  if (!(median > 0.0))
    return {ErrorCode::kDegenerate, "the map's median depth is not in front of the camera, so it cannot be scaled"};
  return nominal_depth_mm / median;
}

Status FillRigidMap(const InitInput& input, const InitialMap& map, const std::vector<Rigid3>& cams_from_world,
                    std::vector<InitRejectedPoint> rejected, double nominal_depth_mm, InitOutcome* outcome) {
  const auto nominal = NominalScale(map.positions, nominal_depth_mm);
  if (!nominal.ok()) return nominal.status();
  const double scale = *nominal;
  outcome->decision = InitDecision::kMap;
  for (std::size_t i = 0; i < map.ids.size(); ++i)
    outcome->points.push_back(
        {map.ids[i], scale * map.positions[i], scale * map.depth_sigmas[i], map.parallaxes_rad[i]});
  std::vector<Rigid3> scaled = cams_from_world;
  for (Rigid3& cam_from_world : scaled) cam_from_world.translation *= scale;
  FillRigidFrames(input, scaled, outcome);
  std::sort(rejected.begin(), rejected.end(),
            [](const InitRejectedPoint& a, const InitRejectedPoint& b) { return a.id < b.id; });
  outcome->rejected = std::move(rejected);
  return Status::Ok();
}

std::string WithGivenUp(const std::string& reason, int frames) {
  const std::size_t last = std::min(reason.rfind("; "), reason.size());
  return reason.substr(0, last) + "; given up after " + std::to_string(frames) + " frames from one reference" +
         reason.substr(last);
}

}  // namespace pliant
