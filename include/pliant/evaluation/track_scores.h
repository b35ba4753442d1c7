// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The measures of TAP-Vid over tracks and frames, which are the same in the images (track_error.h) and in space
// (track_error_3d.h); these say what a distance is, and which frames of a track count. A point is truly visible where
// nothing hides it and it lies in the image.
//   within d            share of the truly visible points whose estimate is nearer than d to the truth; a frame in
//                       which the track has no estimate counts as not
//   occlusion accuracy  share of all points whose visibility is right; no estimate is taken as hidden
//   Jaccard at d        true positives / (truly visible + false positives). True positives are seen, truly visible and
//                       nearer than d; false positives are seen, and hidden in truth or not nearer than d
#pragma once

#include <array>
#include <cstdint>

namespace pliant {

struct TrackScores {
  static constexpr std::array<double, 5> kDistances_px = {1, 2, 4, 8, 16};

  int tracks = 0;           // with a material point that is known in a frame that counts
  int without_truth = 0;    // the others
  std::int64_t points = 0;  // tracks and frames that count
  std::int64_t visible = 0;
  std::array<double, 5> within = {};
  double average_within = 0;  // the mean of these: delta_avg, and in space APD
  double occlusion_accuracy = 0;
  std::array<double, 5> jaccard = {};
  double average_jaccard = 0;
};

}  // namespace pliant
