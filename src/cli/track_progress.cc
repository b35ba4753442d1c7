// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/track_progress.h"

#include <iostream>
#include <string>

namespace pliant::cli {

void TrackProgress::OnStart(int frames) { progress_.emplace(std::cerr, style_, "track", frames); }

void TrackProgress::OnFrame(const FrameReport& report) {
  if (report.state != state_) {
    progress_->Note("frame " + report.name + ": " + std::string(EnumName(report.state)) +
                    (report.note.empty() ? "" : " (" + report.note + ")"));
    state_ = report.state;
  }
  progress_->Update(++done_, std::to_string(report.tracked) + " points");
}

}  // namespace pliant::cli
