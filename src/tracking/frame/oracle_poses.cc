// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/frame/oracle_poses.h"

#include <cassert>

#include "pliant/base/statistics.h"

namespace pliant {

OraclePoses::OraclePoses(const OracleOptions& options, TrackingTruth* truth, std::optional<double> nominal_depth_mm)
    : gives_poses_(options.poses == Switch::kOn), truth_(truth), nominal_depth_mm_(nominal_depth_mm) {
  assert(truth != nullptr || !gives_poses_);
}

void OraclePoses::TakeWorld(const InitInput& input, InitOutcome* outcome) {
  if (!gives_poses_) return;
  const InitFrame& reference = input.frames.front();
  scene_from_world_ = truth_->WorldFromCamera(reference.frame_idx);
  if (nominal_depth_mm_) {
    const auto depths = truth_->DepthsAt(reference.frame_idx, PixelsOf(reference.observations));
    std::vector<double> ratios;
    for (std::size_t k = 0; k < depths.size(); ++k) {
      const InitPoint* point = FindById(outcome->points, reference.observations[k].id);
      if (point != nullptr && depths[k]) ratios.push_back(point->position.z() / *depths[k]);
    }
    if (!ratios.empty()) unit_per_mm_ = Median(std::move(ratios));
  }
  for (InitFrameState& frame : outcome->frames) frame.cam_from_world = *Pose(frame.frame_idx);
}

std::optional<Rigid3> OraclePoses::Pose(int frame_idx) const {
  if (!gives_poses_) return std::nullopt;
  Rigid3 cam_from_world = truth_->WorldFromCamera(frame_idx).Inverse() * scene_from_world_;
  cam_from_world.translation *= unit_per_mm_;
  return cam_from_world;
}

}  // namespace pliant
