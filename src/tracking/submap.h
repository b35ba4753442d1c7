// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A map with all that belongs to it: what the tracker goes on with, and what it keeps of a map that it left.
#pragma once

#include <utility>
#include <vector>

#include "pliant/geometry/sim3.h"
#include "pliant/tracking/tracker.h"
#include "tracking/candidates.h"
#include "tracking/lost_points.h"
#include "tracking/places.h"
#include "tracking/rigid_history.h"

namespace pliant {

struct Tracker::Submap {
  Submap(int submap_idx, const Camera& camera, const TrackerOptions& options)
      : idx(submap_idx),
        point_tracker(options.point_tracker),
        candidates(camera, options.growth),
        places(options.relocalization) {}

  // Into another world; where the two are one.
  void MoveInto(const Sim3& other_from_world);
  // Moves what is now, cameras and points alike, and not where the points rest.
  void MoveAllButRest(const Rigid3& motion);
  // All that `other`, which is in the same world, knows besides: its points are lost ones, which are found where they
  // are in sight. The candidates of both are let go of.
  void TakeOver(Submap&& other);

  int idx;
  Map map;
  PointTracker point_tracker;
  LostPoints lost_points;
  RigidHistory rigid_history;
  Candidates candidates;
  Places places;
  std::vector<InitFrame> window_frames;  // the last ones in which there was a map, with their candidates
  TrackerFrame previous;                 // the last frame in which points were seen
  Rigid3 last_cam_from_world;
  Rigid3 before_last_cam_from_world;
  std::vector<std::pair<int, Rigid3>> recent_poses;  // by frame_idx, of the last frames in a row that were tracked
};

}  // namespace pliant
