// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/recorder.h"

#include "pipeline/working_frame.h"
#include "pliant/base/state_archive.h"

namespace pliant {

Status Recorder::Write(std::vector<FrameReport> reports) {
  for (FrameReport& of_tracker : reports) {
    if (const auto latency = latencies_ms_.extract(of_tracker.frame_idx)) of_tracker.latency_ms = latency.mapped();
    const FrameReport report = InSourcePixels(std::move(of_tracker), working_);
    if (Status written = writer_.Write(report); !written.ok()) return written;
    for (TrackObserver* observer : observers_) observer->OnFrame(report);
  }
  return Status::Ok();
}

void Recorder::Serialize(StateArchive& archive) { archive(before_, latencies_ms_); }

}  // namespace pliant
