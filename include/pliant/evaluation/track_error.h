// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How well points are tracked in the images, by the measures of TAP-Vid (Doersch et al., NeurIPS Datasets and
// Benchmarks 2022), whose query mode is "first": a track's material point is the one that its first seen pixel shows,
// and every later frame counts. Distances are those in images scaled to 256 x 256 pixels. A point is truly visible
// where nothing hides it and it lies in the image.
//   within d            share of the truly visible points whose pixel, seen or hidden, is nearer than d to the truth; a
//                       frame in which the track has no pixel counts as not
//   occlusion accuracy  share of all points whose visibility is right; no pixel is taken as hidden
//   Jaccard at d        true positives / (truly visible + false positives). True positives are seen, truly visible and
//                       nearer than d; false positives are seen, and hidden in truth or not nearer than d
//   survival            mean share of the frames after its first that a track passes before it fails: before the point
//                       is truly visible and the track has no pixel nearer than 50 (Zheng et al., PointOdyssey, ICCV
//                       2023)
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/evaluation/material_truth.h"
#include "pliant/scene/pixel_track.h"

namespace pliant {

struct TrackError {
  static constexpr std::array<double, 5> kDistances_px = {1, 2, 4, 8, 16};  // of 256

  int tracks = 0;           // with a material point that is known in a later frame
  int without_truth = 0;    // that start where there is none, or in the last frame
  std::int64_t points = 0;  // tracks and frames that count
  std::int64_t visible = 0;
  std::array<double, 5> within = {};
  double average_within = 0;  // the mean of these: delta_avg
  double occlusion_accuracy = 0;
  std::array<double, 5> jaccard = {};
  double average_jaccard = 0;
  double survival = 0;
  double median_px = 0;  // distance of the seen pixels of truly visible points, in pixels of the image itself
};

// `frames` ascend: those in which the tracks could have been followed. Fails as the truth does, and with kInsufficient
// where no track has a material point that is visible in a later frame.
Result<TrackError> ComputeTrackError(std::span<const PixelTrack> tracks, std::span<const int> frames,
                                     const Camera& camera, MaterialTruth& truth);

}  // namespace pliant
