// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A first map that was made beside tracking is of an earlier frame. On its way to the present one it meets the frames
// since, through which its points were followed without a map (docs/method.md, "Maps beside tracking").
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "pliant/tracking/stage_times.h"
#include "tracking/frame_result.h"

namespace pliant {

class CatchUp {
 public:
  // The parts must outlive this. `submap`: without a map; `present`: what is followed now, of which the map keeps its
  // points.
  CatchUp(FirstMap first, Submap submap, const InitFrame& present, const TrackerOptions& options, TrackSource* tracks,
          const FrameTracker* frame_tracker, MapUpdater* map_updater);

  // `frames`: those since the reference. Solves the next ones, at most so many, and completes their reports where these
  // are held. `result`: of the one that is not held, which is the present frame.
  void GoOn(const std::vector<InitFrame>& frames, std::size_t most, std::vector<FrameReport>* held, StageTimes* times,
            FrameResult* result);
  // The frames that it has reached, the map's own included.
  std::size_t reached() const { return reached_; }
  // Of the last of them: tracking or lost, and why.
  TrackingState state() const { return state_; }
  const std::string& failure() const { return failure_; }

  // Once it has reached the last frame: the submap with its points and, as candidates, those that are followed since.
  Submap TakeSubmap(const InitFrame& present);
  FirstMap TakeFirst() { return std::move(first_); }

 private:
  TrackingState Solve(const InitFrame& frame, StageTimes* times, FrameResult* result);

  TrackerOptions options_;
  TrackSource* tracks_;
  const FrameTracker* frame_tracker_;
  MapUpdater* map_updater_;
  FirstMap first_;
  Submap submap_;
  std::size_t reached_;
  TrackingState state_ = TrackingState::kTracking;
  std::string failure_;
};

}  // namespace pliant
