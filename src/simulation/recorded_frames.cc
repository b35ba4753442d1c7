// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/recorded_frames.h"

#include <algorithm>
#include <cstdint>

#include "pliant/base/random.h"

namespace pliant::simulation {

std::vector<RecordedFrame> RecordedFrames(const SimulationOptions& options) {
  const SimulationOptions::Recording& recording = options.recording;
  Random random = Random(static_cast<std::uint64_t>(options.scene.seed)).Child("lost frames");
  // Runs of geometric length; between them as many recorded frames, in the mean, as the share of lost ones asks for.
  const double ends = 1.0 / recording.lost_run;
  const double begins =
      recording.lost_share > 0 ? std::min(1.0, ends * recording.lost_share / (1.0 - recording.lost_share)) : 0.0;
  std::vector<RecordedFrame> recorded = {{0, 0}};
  bool lost = false;
  bool repeats = false;
  for (int frame_idx = 1; frame_idx < options.trajectory.frames; ++frame_idx) {
    const bool was_lost = lost;
    lost = random.Uniform() < (was_lost ? 1.0 - ends : begins);
    if (lost && !was_lost) repeats = random.Uniform() < recording.repeated_share;
    if (!lost)
      recorded.push_back({frame_idx, frame_idx});
    else if (repeats)
      recorded.push_back({recorded.back().shown_idx, frame_idx});
  }
  return recorded;
}

}  // namespace pliant::simulation
