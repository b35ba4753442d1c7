// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The progress of a run on standard error: frames, rate and points, and a line whenever the tracker changes its state.
#pragma once

#include <optional>

#include "cli/progress.h"
#include "pliant/pipeline/track.h"

namespace pliant::cli {

class TrackProgress : public TrackObserver {
 public:
  explicit TrackProgress(ProgressStyle style = ProgressStyleOfStandardError()) : style_(style) {}
  void OnWarning(const std::string& sentence) override;
  void OnStart(int frames) override;
  void OnFrame(const FrameReport& report) override;
  void OnHeld(const FrameReport& report) override;

 private:
  void Show(const FrameReport& report);

  ProgressStyle style_;
  std::optional<Progress> progress_;
  TrackingState state_ = TrackingState::kWaitingForReference;
  int done_ = 0;
  int shown_frame_idx_ = -1;  // the last one
};

}  // namespace pliant::cli
