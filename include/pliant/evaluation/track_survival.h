// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How long points live, and whether the run survives an interruption of its view: an accurate figure over a handful of
// survivors is no tracking.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "pliant/base/ids.h"

namespace pliant {

// The ids seen in one frame; `ids` is empty and `tracked` false where the frame was not tracked.
struct FrameTracks {
  int frame_idx = 0;
  bool tracked = false;
  std::vector<PointId> ids;
  int submap = 0;  // in which it was tracked
};

struct TrackSurvival {
  struct Frame {
    int frame_idx = 0;
    bool tracked = false;
    int points = 0;          // followed in this frame
    int alive_of_first = 0;  // of them, those of the first tracked frame
  };
  int frames_read = 0;
  int frames_tracked = 0;
  int first_points = 0;         // in the first tracked frame
  int last_points = 0;          // in the last tracked frame
  double mean_points = 0;       // over the tracked frames
  int last_alive_of_first = 0;  // of the first frame's points, those seen in the last tracked frame
  // Of the first tracked frame's points the share that is seen a quarter, a half, three quarters and all of the way
  // from there to the last frame read, or later: a point that is lost for a while and found again is alive in between.
  std::array<double, 4> alive_shares = {0, 0, 0, 0};
  int tracks = 0;                  // different points in all
  double median_track_length = 0;  // frames in which a point was seen
  double mean_track_length = 0;
  int submaps = 0;                 // in which frames were tracked
  int interruptions = 0;           // frames in a row that were not tracked, after one that was
  int interruptions_survived = 0;  // after which tracking went on in the same submap, or one merged with it
  int returned_points = 0;         // that were missing in a tracked frame and seen again
  std::vector<Frame> frames;       // one a frame read
};

TrackSurvival ComputeTrackSurvival(std::span<const FrameTracks> frames);

}  // namespace pliant
