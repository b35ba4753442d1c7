// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A map with all that belongs to it, while another one is the present one.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "pliant/tracking/tracker.h"
#include "tracking/candidates.h"
#include "tracking/lost_points.h"
#include "tracking/places.h"
#include "tracking/rigid_history.h"

namespace pliant {

struct Tracker::Submap {
  explicit Submap(const PointTrackerOptions& options) : point_tracker(options) {}

  int idx = 0;
  Map map;
  PointTracker point_tracker;
  std::unique_ptr<LostPoints> lost_points;
  std::unique_ptr<RigidHistory> rigid_history;
  std::unique_ptr<Candidates> candidates;
  std::unique_ptr<Places> places;
  std::vector<InitFrame> window_frames;
  TrackerFrame previous;
  Rigid3 last_cam_from_world;
  Rigid3 before_last_cam_from_world;
  std::vector<std::pair<int, Rigid3>> recent_poses;
};

}  // namespace pliant
