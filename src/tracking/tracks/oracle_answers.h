// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The truth in the tracker's own terms: its frames and units. The tracker asks for the first map and for a frame's
// pose; true tracks are a source of tracks (tracks/oracle_tracks.h).
#pragma once

#include <optional>

#include "pliant/tracking/oracle.h"

namespace pliant {

class OracleAnswers {
 public:
  // `truth` may be null when nothing is switched on; it must outlive this. `nominal_depth_mm`: what a map's median
  // depth is scaled to; nothing for a method whose maps are metric.
  OracleAnswers(const OracleOptions& options, TrackingTruth* truth, std::optional<double> nominal_depth_mm);

  bool gives_first_map() const { return options_.first_map == Switch::kOn; }
  bool gives_poses() const { return options_.poses == Switch::kOn; }

  // The map from the reference alone, the input's one frame; a new reference where fewer than `min_points` corners show
  // the surface.
  InitOutcome FirstMap(const InitInput& input, int min_points) const;
  // To be called with every first map: fixes the world frame and the unit of the poses, and puts the true poses in the
  // place of the map's own. No effect when poses are not switched on.
  void TakeWorld(const InitInput& input, InitOutcome* outcome);

  // cam_from_world in the world and unit of the map; nothing when poses are not switched on.
  std::optional<Rigid3> Pose(int frame_idx) const;

 private:
  OracleOptions options_;
  TrackingTruth* truth_;
  std::optional<double> nominal_depth_mm_;
  Rigid3 scene_from_world_;  // of the tracker's world, the reference camera
  double unit_per_mm_ = 1;
};

}  // namespace pliant
