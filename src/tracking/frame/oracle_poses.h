// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The true poses of a simulated scene, in the world and unit of the tracker's map (Oracle.poses).
#pragma once

#include <optional>

#include "pliant/tracking/bootstrapping/initializer.h"
#include "pliant/tracking/tracks/oracle.h"

namespace pliant {

class OraclePoses {
 public:
  // `truth` may be null when poses are not switched on; it must outlive this. `nominal_depth_mm`: what a map's median
  // depth is scaled to; nothing for a method whose maps are metric.
  OraclePoses(const OracleOptions& options, TrackingTruth* truth, std::optional<double> nominal_depth_mm);

  // To be called with every first map: fixes the world frame and the unit of the poses, and replaces the map's own
  // poses by the true ones. No effect when poses are not switched on.
  void TakeWorld(const InitInput& input, InitOutcome* outcome);

  // cam_from_world in the world and unit of the map; nothing when poses are not switched on.
  std::optional<Rigid3> Pose(int frame_idx) const;

 private:
  bool gives_poses_;
  TrackingTruth* truth_;
  std::optional<double> nominal_depth_mm_;
  Rigid3 scene_from_world_;  // of the tracker's world, the reference camera
  double unit_per_mm_ = 1;
};

}  // namespace pliant
