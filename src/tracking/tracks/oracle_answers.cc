// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/tracks/oracle_answers.h"

#include <algorithm>
#include <cassert>
#include <string>

#include "pliant/base/statistics.h"
#include "tracking/initial_map.h"

namespace pliant {
namespace {

std::vector<Eigen::Vector2d> PixelsOf(const InitFrame& frame) {
  std::vector<Eigen::Vector2d> pixels;
  for (const InitObservation& observation : frame.observations) pixels.push_back(observation.pixel);
  return pixels;
}

}  // namespace

bool OracleOptions::Any() const { return !Names().empty(); }

std::vector<std::string_view> OracleOptions::Names() const {
  std::vector<std::string_view> names;
  if (first_map == Switch::kOn) names.emplace_back("first_map");
  if (tracks == Switch::kOn) names.emplace_back("tracks");
  if (poses == Switch::kOn) names.emplace_back("poses");
  return names;
}

void OracleOptions::List(OptionTable& table) {
  table.BeginGroup("Oracle",
                   "parts of the method replaced by the truth of a simulated sequence, to see what bounds it");
  table.AddChoice("first_map", &first_map, "on: the first map's points have their true depths");
  table.AddChoice("tracks", &tracks, "on: points are at the pixels of the material points that they started on");
  table.AddChoice("poses", &poses, "on: the camera's poses are the true ones, and held");
}

OracleAnswers::OracleAnswers(const OracleOptions& options, TrackingTruth* truth, std::optional<double> nominal_depth_mm)
    : options_(options), truth_(truth), nominal_depth_mm_(nominal_depth_mm) {
  assert(truth != nullptr || !options.Any());
}

InitOutcome OracleAnswers::FirstMap(const InitInput& input, int min_points) const {
  const InitFrame& reference = input.frames.front();
  const auto depths = truth_->DepthsAt(reference.frame_idx, PixelsOf(reference));
  InitOutcome outcome;
  InitialMap map;
  std::vector<InitRejectedPoint> rejected;
  std::vector<double> z_mm;
  for (std::size_t k = 0; k < depths.size(); ++k) {
    const PointId id = reference.observations[k].id;
    const auto ray = input.camera.Unproject(reference.observations[k].pixel);
    if (!ray || ray->z() <= 0 || !depths[k]) {
      rejected.push_back({id, InitRejection::kNoRay});
      continue;
    }
    map.ids.push_back(id);
    map.positions.push_back(*ray * (*depths[k] / ray->z()));
    z_mm.push_back(*depths[k]);
  }
  map.depth_sigmas.assign(map.ids.size(), 0.0);
  map.parallaxes_rad.assign(map.ids.size(), 0.0);
  outcome.measured.correspondences = static_cast<int>(depths.size());
  outcome.measured.inliers = static_cast<int>(map.ids.size());
  const std::string count = std::to_string(map.ids.size());
  outcome.decision = InitDecision::kNewReference;
  if (outcome.measured.inliers < min_points) {
    outcome.reason = "only " + count + " corners lie on the surface, of at least " + std::to_string(min_points);
    return outcome;
  }
  const double median_mm = nominal_depth_mm_ ? *nominal_depth_mm_ : Median(std::move(z_mm));
  const Status handed = HandOver(input, map, {Rigid3()}, std::move(rejected), median_mm, &outcome);
  outcome.reason = handed.ok() ? "first map of " + count + " points at their true depths" : handed.message();
  return outcome;
}

void OracleAnswers::TakeWorld(const InitInput& input, InitOutcome* outcome) {
  if (!gives_poses()) return;
  const InitFrame& reference = input.frames.front();
  scene_from_world_ = truth_->WorldFromCamera(reference.frame_idx);
  if (nominal_depth_mm_) {
    const auto depths = truth_->DepthsAt(reference.frame_idx, PixelsOf(reference));
    std::vector<double> ratios;
    for (std::size_t k = 0; k < depths.size(); ++k) {
      const InitPoint* point = FindById(outcome->points, reference.observations[k].id);
      if (point != nullptr && depths[k]) ratios.push_back(point->position.z() / *depths[k]);
    }
    if (!ratios.empty()) unit_per_mm_ = Median(std::move(ratios));
  }
  for (InitFrameState& frame : outcome->frames) frame.cam_from_world = *Pose(frame.frame_idx);
}

std::optional<Rigid3> OracleAnswers::Pose(int frame_idx) const {
  if (!gives_poses()) return std::nullopt;
  Rigid3 cam_from_world = truth_->WorldFromCamera(frame_idx).Inverse() * scene_from_world_;
  cam_from_world.translation *= unit_per_mm_;
  return cam_from_world;
}

}  // namespace pliant
