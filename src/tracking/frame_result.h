// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the conductor knows of a frame when it is done, and the report that is made of it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/scene/frame_report.h"
#include "pliant/tracking/stage_times.h"
#include "tracking/bootstrapping/bootstrapper.h"
#include "tracking/frame/frame_tracker.h"
#include "tracking/map_upkeep/map_updater.h"
#include "tracking/submap/submap.h"
#include "tracking/tracks/loss_counts.h"

namespace pliant {

// What one frame gave, for its report.
struct FrameResult {
  int tracked = 0;  // points followed into the frame, before any was rejected
  LossCounts losses = {};
  std::string note = {};
  std::vector<CostTerm> costs = NoFrameCosts();
  double median_reprojection_error_px = 0;
  MapUpdate update = {};
  std::optional<FirstMap> first_map = std::nullopt;
  bool has_caught_up = false;                             // of an earlier frame, and solved in this one
  std::optional<PreparedFrame> map_frame = std::nullopt;  // that made it, where tracking goes on after an earlier one
};

// How much of what the frame shows has a point of `report`, and, of `candidates`, one that is followed.
void AddCoverage(const PreparedFrame& frame, const Candidates& candidates, FrameReport* report);

// What a solved frame gave.
void AddSolved(const SolvedFrame& solved, FrameResult* result);

// The state of a frame, of the submap as it is in the end.
TrackingState ReportedState(TrackingState state, const Submap& submap);
// What a frame's solution says; `submap`: in the end of the frame.
void AddSolution(const Submap& submap, const FrameResult& result, FrameReport* report);
// The report of a frame in this state.
FrameReport MakeReport(const PreparedFrame& frame, TrackingState state, const Submap& submap, const FrameResult& result,
                       const StageTimes& times);

void AddLosses(const LossCounts& losses, FrameReport* report);
// The attempt after the last frame is reported with that frame.
void AddLastAttempt(const BootstrapStep& step, const StageTimes& times, FrameReport* report);
// Frames in which points were followed from a reference that came to nothing, since camera and scene could not be told
// apart; nothing where there is no `reason`. `since_frame_idx`: the reference.
void MarkAmbiguous(const std::string& reason, int since_frame_idx, std::vector<FrameReport>* reports);

}  // namespace pliant
