// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/run_frames.h"

#include "pliant/base/text.h"

namespace pliant {

Result<std::vector<int>> FramesWithPose(const std::string& path, const Run& run) {
  std::vector<int> frames_idx;
  for (const RunPose& pose : run.poses) {
    if (!pose.frame_idx)
      return Status(ErrorCode::kMismatch, Quoted(path) +
                                              " has no frames.csv, so it is another program's; make it a run with "
                                              "pliant import --format result");
    frames_idx.push_back(*pose.frame_idx);
  }
  return frames_idx;
}

}  // namespace pliant
