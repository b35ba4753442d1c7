// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Which of the camera's frames a recording has: some are lost, in runs, and the recorder leaves a gap in time or
// records the frame before once more.
#pragma once

#include <vector>

#include "pliant/simulation/options.h"

namespace pliant::simulation {

// Indices of the camera's frames, from 0.
struct RecordedFrame {
  int shown_idx = 0;  // whose image, pose and depth it has
  int clock_idx = 0;  // whose timestamp it has; larger than shown_idx where an earlier frame is repeated
};

// In the order of time; timestamps increase. The camera's first frame is always recorded. Where nothing is lost: every
// frame at its time.
std::vector<RecordedFrame> RecordedFrames(const SimulationOptions& options);

}  // namespace pliant::simulation
