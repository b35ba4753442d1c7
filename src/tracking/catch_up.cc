// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/catch_up.h"

#include <algorithm>
#include <utility>

namespace pliant {

CatchUp::CatchUp(FirstMap first, Submap submap, const InitFrame& present, const TrackerOptions& options,
                 TrackSource* tracks, const FrameTracker* frame_tracker, MapUpdater* map_updater)
    : options_(options),
      tracks_(tracks),
      frame_tracker_(frame_tracker),
      map_updater_(map_updater),
      first_(std::move(first)),
      submap_(std::move(submap)),
      reached_(first_.frames.size()) {
  map_updater_->Start(first_, &submap_);
  map_updater_->KeepFollowed(present, &submap_);
}

void CatchUp::GoOn(const std::vector<InitFrame>& frames, std::size_t most, std::vector<FrameReport>* held,
                   StageTimes* times, FrameResult* result) {
  for (const std::size_t end = std::min(frames.size(), reached_ + most); reached_ < end; ++reached_) {
    const InitFrame& frame = frames[reached_];
    FrameResult solved;
    state_ = Solve(frame, times, &solved);
    const auto report = std::ranges::find(*held, frame.frame_idx, &FrameReport::frame_idx);
    if (report == held->end()) {
      result->losses.Add(solved.losses);
      result->costs = std::move(solved.costs);
      result->median_reprojection_error_px = solved.median_reprojection_error_px;
      continue;
    }
    report->state = ReportedState(state_, submap_);
    report->note = failure_.empty() ? "solved when the first map had been made, of earlier frames" : failure_;
    AddLosses(solved.losses, &*report);
    if (state_ == TrackingState::kTracking) AddSolution(submap_, solved, &*report);
  }
}

// A frame into which the points were followed before there was a map: no lost ones are searched.
TrackingState CatchUp::Solve(const InitFrame& frame, StageTimes* times, FrameResult* result) {
  PreparedFrame number_alone;
  number_alone.frame_idx = frame.frame_idx;
  const SolvedFrame solved = frame_tracker_->Solve(number_alone, TrackingState::kInitializing,
                                                   frame_tracker_->Followed(frame, submap_), &submap_, times);
  failure_ = solved.failure;
  if (!failure_.empty()) return TrackingState::kLost;
  submap_.Commit(solved.points, solved.solution.cam_from_world, state_, options_, tracks_);
  map_updater_->RemoveCommonMotion(&submap_);
  map_updater_->AddFollowed(frame, &submap_);
  AddSolved(solved, result);
  return TrackingState::kTracking;
}

Submap CatchUp::TakeSubmap(const InitFrame& present) {
  map_updater_->KeepFollowed(present, &submap_);
  // The source has forgotten them, in the frame in which they were lost.
  submap_.lost_points.Clear();
  if (state_ == TrackingState::kTracking) {
    map_updater_->AdoptFollowed(first_.frames.back(), present, &submap_);
  } else {
    // The map's points are described there, to be found again; nobody follows the others any more.
    for (const InitObservation& seen : present.observations) {
      if (Landmark* landmark = submap_.map.Find(seen.id); landmark != nullptr)
        landmark->pixel = seen.pixel;
      else if (submap_.candidates.Pixel(seen.id) == nullptr)
        tracks_->Remove(seen.id);
    }
  }
  return std::move(submap_);
}

}  // namespace pliant
