// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/run_views.h"

#include <algorithm>

#include "pipeline/run_frames.h"

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
  while (next_ <= position) {
    auto read = sequence_->Next();
    if (!read.ok()) return read.status();
    if (!read->has_value())
      return {ErrorCode::kMismatch, "the images end before frame " + std::to_string(frames_[next_].frame_idx) +
                                        " of the run; are they those that were tracked?"};
    const SequenceFrame& frame = **read;
    if (frame.frame_idx < frames_[next_].frame_idx) continue;
    if (frame.frame_idx > frames_[next_].frame_idx)
      return {ErrorCode::kMismatch, "the images have no frame " + std::to_string(frames_[next_].frame_idx) +
                                        " of the run; are they those that were tracked?"};
    if (Status status = CheckIsOfRun(frame); !status.ok()) return status;
    if (is_needed(next_))
      views_[next_] = {frame.image, ValidMask(frame.image, frame.mask, masks_), frames_[next_].cam_from_world,
                       frames_[next_].observations};
    ++next_;
  }
  return Status::Ok();
}

void RunViews::ForgetUnless(const std::function<bool(std::size_t)>& is_needed) {
  std::erase_if(views_, [&](const auto& entry) { return !is_needed(entry.first); });
}

Status RunViews::CheckIsOfRun(const SequenceFrame& frame) const {
  const std::string number = std::to_string(frame.frame_idx);
  if (frame.image.cols != known_.camera->width() || frame.image.rows != known_.camera->height())
    return {ErrorCode::kMismatch, "image " + frame.name +
                                      " has not the size of the run's camera; are the images "
                                      "those that were tracked?"};
  const auto name = known_.names.find(frame.frame_idx);
  if (name != known_.names.end() && !frame.name.empty() && name->second != frame.name)
    return {ErrorCode::kMismatch, "frame " + number + " of the run is image " + name->second + ", and here it is " +
                                      frame.name + "; are the images those that were tracked?"};
  return Status::Ok();
}

}  // namespace pliant
