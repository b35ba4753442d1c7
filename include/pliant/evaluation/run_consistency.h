// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Whether runs of one recording agree, which needs no truth: runs that were begun at another frame, with another seed,
// with fewer points or backwards. In every frame that both have, the points of the run are compared with the nearest
// points of the other run, if they are near enough: their depths, after one scale a frame (relative_depth.h). Beside
// the difference stands the null, the spread of the run's own depths: where the runs do not differ by clearly less,
// their depth is worth no more than one constant depth. Their camera paths are compared after a similarity. Runs that
// agree can still be wrong together.
#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/evaluation/relative_depth.h"
#include "pliant/evaluation/run_input.h"
#include "pliant/evaluation/trajectory_error.h"

namespace pliant {

// How the frames of the other run are numbered.
enum class FrameOrder {
  kSame,
  kReversed,  // its images are those of the run from the last to the first
};

template <>
struct EnumNames<FrameOrder> {
  static constexpr std::array kNames = {std::pair{FrameOrder::kSame, std::string_view("same")},
                                        std::pair{FrameOrder::kReversed, std::string_view("reversed")}};
};

struct RunConsistencyOptions {
  double max_distance = 0.01;  // between two points that are compared, by the image's width
  int min_points = 8;          // compared in a frame that counts
  FrameOrder order = FrameOrder::kSame;

  void List(OptionTable& table);
};

// `width_px`: the image's width. Points behind their camera are left out. Of a run in reversed order frame 0 is the
// last one of the recording, and its last frame read the first one. Fails with kInsufficient where no frame has enough
// points to compare.
Result<RelativeDepthError> CompareRuns(const EvaluationInput& run, const EvaluationInput& other, int width_px,
                                       const RunConsistencyOptions& options);

// The camera path of the run against that of the other run, which stands where the truth does: lengths are in its map
// units, not in millimeters. Frames in the same two submaps are aligned together. Fails as ComputeTrajectoryError.
Result<TrajectoryError> CompareCameraPaths(const EvaluationInput& run, const EvaluationInput& other,
                                           const RunConsistencyOptions& options,
                                           const TrajectoryErrorOptions& trajectory);

}  // namespace pliant
