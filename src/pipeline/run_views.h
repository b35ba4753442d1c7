// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The frames of a run that a surface is made of: their poses and points from the run folder, their images from the
// sequence.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/point_colors.h"
#include "pliant/base/status.h"
#include "pliant/datasets/sequence.h"
#include "pliant/image/masks.h"
#include "pliant/io/run_map.h"
#include "pliant/io/run_reader.h"
#include "pliant/surface/dense_depth.h"

namespace pliant {

// A frame of one submap of a run.
struct PosedFrame {
  int frame_idx = 0;
  int submap = 0;
  double timestamp_s = 0;
  bool provisional = false;  // TrackingState; another program's run does not say
  Rigid3 cam_from_world;
  std::vector<PointObservation> observations;  // sorted by id
};

// All that have a pose, in the order of time. Fails as FramesWithPose and ForEachFrame do.
Result<std::vector<PosedFrame>> ReadPosedFrames(const std::string& path, const Run& run);

// Views of posed frames, read in order and kept as long as they are needed. What it is made from has to outlive it.
class RunViews {
 public:
  // `pair_threads`: to bring right images into the run's unit; 0: these are not read.
  RunViews(std::unique_ptr<Sequence> sequence, const std::vector<PosedFrame>& frames, const RunMap& known,
           const MaskOptions& masks, int pair_threads = 0)
      : sequence_(std::move(sequence)),
        frames_(frames),
        known_(known),
        masks_(masks),
        pair_threads_(pair_threads),
        colors_(known) {}

  // Reads up to the frame at `position` of the posed frames, and keeps those for which `is_needed`. Fails as Sequence,
  // and with kMismatch where the images are not those of the run.
  // Right images are read of those for which `needs_right`.
  Status ReadUntil(std::size_t position, const std::function<bool(std::size_t)>& is_needed,
                   const std::function<bool(std::size_t)>& needs_right = {});
  // Of a frame that was read and kept.
  const SurfaceView& At(std::size_t position) const { return views_.at(position); }
  // What the right camera of a pair has seen at the same time, in the run's unit; null where there is none, or its
  // depths are not those of the run's points but for a factor.
  const SurfaceView* RightOf(std::size_t position) const;
  // CV_8UC1, 0 = not tissue: excluded by a mask, or outside of the field of view. Tissue under a highlight is.
  cv::Mat TissueIn(std::size_t position) const;
  void ForgetUnless(const std::function<bool(std::size_t)>& is_needed);
  // Whether what was read so far shows other things than the run was tracked in.
  bool AreOfOtherImages() const { return colors_.AreOfOtherImages(); }

 private:
  // As it is compared: of one time.
  cv::Mat ImageOf(const cv::Mat& source) const;
  std::optional<SurfaceView> RightView(const SurfaceView& left, const cv::Mat& mask, const cv::Mat& right) const;

  std::unique_ptr<Sequence> sequence_;
  const std::vector<PosedFrame>& frames_;
  const RunMap& known_;
  const MaskOptions& masks_;
  int pair_threads_;
  PointColors colors_;
  std::map<std::size_t, SurfaceView> views_;
  std::map<std::size_t, SurfaceView> rights_;
  std::map<std::size_t, cv::Mat> masks_given_;
  std::size_t next_ = 0;
};

}  // namespace pliant
