// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Depths of one run against other depths at the same pixels, where neither has a unit: those of another run
// (run_consistency.h), or of structure from motion (sfm_error.h). Of the points i of one frame, each with its depth z_i
// and the other depth z'_i:
//   e = median_i | ln r_i - median_j ln r_j |,   r_i = z_i / z'_i       one scale a frame
// which is the relative difference of the depths where it is small, and does not change when the two are exchanged.
// Beside it stands the null: the same of the depths themselves, r_i = z_i (or z'_i where these are the truth), the
// error of one constant depth. Of several frames: the median of the frames' values, so that no frame counts more for
// its points.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "pliant/base/status.h"

namespace pliant {

// Two depths at one pixel, both positive; each in a unit of its own.
struct DepthPair {
  double depth = 0;  // of the run
  double other = 0;
};

struct RelativeDepthFrame {
  int frame_idx = 0;
  int points = 0;
  double difference = 0;  // e
  double null = 0;        // that of one constant depth
};

struct RelativeDepthError {
  int points = 0;                          // compared, over all frames
  double difference = 0;                   // median over the frames
  double null = 0;                         // median over the frames
  std::vector<RelativeDepthFrame> frames;  // those with enough points, in order
};

// Whose depths the null is of.
enum class NullDepths { kOfRun, kOfOther };

// e of one frame, whose pairs must not be none.
RelativeDepthFrame CompareDepths(int frame_idx, std::span<const DepthPair> pairs, NullDepths null);

// Over the frames. Fails with kInsufficient, saying `why`, where there is none.
Result<RelativeDepthError> Summarize(std::vector<RelativeDepthFrame> frames, const std::string& why);

}  // namespace pliant
