// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the tracker reports, on its way to the run folder and to the observers.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "pipeline/frame_source.h"
#include "pipeline/frames_before.h"
#include "pliant/base/status.h"
#include "pliant/image/working_image.h"
#include "pliant/io/run_writer.h"
#include "pliant/pipeline/track.h"

namespace pliant {

// Final reports on their way to the run folder and then to the observers.
class Recorder {
 public:
  // `writer` and the observers must outlive this.
  Recorder(RunWriter& writer, std::span<TrackObserver* const> observers, const WorkingImage& working,
           FramesBefore before)
      : writer_(writer), observers_(observers), working_(working), before_(std::move(before)) {}

  // The frame's latency, once it is known; to be called before its report is recorded.
  void SetLatency(int frame_idx, double ms) { latencies_ms_[frame_idx] = ms; }
  Status Record(std::vector<FrameReport> reports) { return Write(before_.Pass(std::move(reports))); }
  // No map comes any more.
  Status Finish() { return Write(before_.Finish()); }
  void Serialize(StateArchive& archive);
  void Show(const ReadFrame& read) {
    for (TrackObserver* observer : observers_) observer->OnImage(read.frame.frame_idx, read.image);
  }
  void Announce(const FrameReport& held) {
    for (TrackObserver* observer : observers_) observer->OnHeld(held);
  }

 private:
  Status Write(std::vector<FrameReport> reports);

  RunWriter& writer_;
  std::span<TrackObserver* const> observers_;
  WorkingImage working_;
  FramesBefore before_;
  std::map<int, double> latencies_ms_;  // of frames that are not written yet
};

}  // namespace pliant
