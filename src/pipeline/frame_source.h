// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Frames of a sequence, read and prepared ahead, in which one can go back: then some are read once more.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <opencv2/core/mat.hpp>

#include "pipeline/run_start.h"
#include "pliant/base/prefetcher.h"
#include "pliant/base/status.h"
#include "pliant/datasets/check_images.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/pipeline/track.h"
#include "pliant/tracking/prepared_frame.h"

namespace pliant {

struct ReadFrame {
  PreparedFrame frame;
  cv::Mat image;  // as the source has it
  // Of reading its depth image, or its right one; empty: neither is wanted of it. Asked while the tracker needs depth.
  std::function<Status()> depth_status;
  // After this frame the run may be resumed: what the sequence knows of its images so far (CheckedSequence). Else
  // empty.
  std::string checked;
};

class FrameSource {
 public:
  // All are used as long as this lives. `last_frame_idx`: the frame before the first; -1: there is none.
  // `checkpoint_frames`: after each so many frames since input.start the run may be resumed; 0: after none.
  FrameSource(CheckedSequence& sequence, const SequenceRequest& input, const TrackOptions& options,
              const RunStart& start, bool wants_depth, int last_frame_idx, int checkpoint_frames);

  // Nothing at the end. An image of a file arrives when it is asked for.
  std::optional<Result<ReadFrame>> Next();
  // Of those that came for the first time the last one, and for how long it has been there.
  int last_frame_idx() const { return last_frame_idx_; }
  double LatencyMs() const { return std::chrono::duration<double, std::milli>(Clock::now() - arrived_).count(); }
  // Where no other map may follow the first one, nothing is read for it any more; what was read ahead in the meantime
  // changes nothing.
  void SetWantsDepth(bool wants) { wants_depth_ = wants; }
  // What comes next is the frame after this one, which has come already. Fails as OpenSequence does.
  Status GoBackTo(int frame_idx);

 private:
  using Clock = std::chrono::steady_clock;
  using Frames = std::optional<Prefetcher<Result<ReadFrame>>>;

  std::optional<Result<ReadFrame>> Read(Sequence& sequence) const;
  void ReadAhead(std::function<std::optional<Result<ReadFrame>>()> read, Frames* frames) const;
  bool IsCheckpoint(int frame_idx) const;

  const SequenceRequest& input_;
  const TrackOptions& options_;
  const RunStart& start_;
  std::atomic<bool> wants_depth_;
  int checkpoint_frames_;
  int last_frame_idx_;  // of the frames that came for the first time
  Clock::time_point arrived_;
  std::unique_ptr<Sequence> reopened_;
  Frames frames_;
  Frames again_;
};

}  // namespace pliant
