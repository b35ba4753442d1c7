// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/track_progress.h"

#include <algorithm>
#include <iostream>
#include <string>

#include "cli/messages.h"

namespace pliant::cli {

void TrackProgress::OnStart(int frames) { progress_.emplace(std::cerr, style_, "track", frames); }

void TrackProgress::OnWarning(const std::string& sentence) {
  if (progress_) progress_->ClearBar();
  SayWarning(sentence);
}

// A frame that was shown when it was processed is not shown again when its report is final.
void TrackProgress::OnFrame(const FrameReport& report) {
  if (report.frame_idx > shown_frame_idx_) Show(report);
}

void TrackProgress::OnHeld(const FrameReport& report) { Show(report); }

void TrackProgress::Show(const FrameReport& report) {
  if (report.frame_idx > shown_frame_idx_) ++done_;  // tracking may have gone back
  shown_frame_idx_ = std::max(shown_frame_idx_, report.frame_idx);
  if (report.state != state_ || report.merge) {
    progress_->Note("frame " + report.name + ": " + std::string(EnumName(report.state)) +
                    (report.note.empty() ? "" : " (" + report.note + ")"));
    state_ = report.state;
  }
  progress_->Update(done_, std::to_string(report.tracked) + " points");
}

}  // namespace pliant::cli
