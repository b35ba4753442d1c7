// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/run_views.h"

#include <algorithm>

#include "pipeline/run_frames.h"
#include "pliant/datasets/run_sequence.h"

namespace pliant {

Result<std::vector<PosedFrame>> ReadPosedFrames(const std::string& path, const Run& run) {
  const auto frames_idx = FramesWithPose(path, run);
  if (!frames_idx.ok()) return frames_idx.status();
  std::vector<PosedFrame> frames;
  for (const RunPose& pose : run.poses)
    frames.push_back({*pose.frame_idx, pose.submap, pose.timestamp_s, pose.world_from_cam.Inverse(), {}});
  const Status status = ForEachFrame(path, *frames_idx, [&](std::size_t k, const auto& observations) {
    frames[k].observations = observations;
    std::ranges::sort(frames[k].observations, {}, &PointObservation::id);
    return Status::Ok();
  });
  if (!status.ok()) return status;
  return frames;
}

Status RunViews::ReadUntil(std::size_t position, const std::function<bool(std::size_t)>& is_needed) {
  for (; next_ <= position; ++next_) {
    const PosedFrame& posed = frames_[next_];
    const auto name = known_.names.find(posed.frame_idx);
    const auto frame = NextFrameOfRun(*known_.camera, posed.frame_idx,
                                      name != known_.names.end() ? name->second : std::string(), sequence_.get());
    if (!frame.ok()) return frame.status();
    if (is_needed(next_))
      views_[next_] = {frame->image, ValidMask(frame->image, frame->mask, masks_), posed.cam_from_world,
                       posed.observations};
  }
  return Status::Ok();
}

void RunViews::ForgetUnless(const std::function<bool(std::size_t)>& is_needed) {
  std::erase_if(views_, [&](const auto& entry) { return !is_needed(entry.first); });
}

}  // namespace pliant
