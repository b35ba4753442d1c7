// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How well points are tracked in the images, by the measures of TAP-Vid (Doersch et al., NeurIPS Datasets and
// Benchmarks 2022; track_scores.h), whose query mode is "first": a track's material point is the one that its first
// seen pixel shows, and every later frame counts. Distances are those in images scaled to 256 x 256 pixels, also of
// pixels where a track is thought to be hidden. Beside them:
//   survival            mean share of the frames after its first that a track passes before it fails: before the point
//                       is truly visible and the track has no pixel nearer than 50 (Zheng et al., PointOdyssey, ICCV
//                       2023)
#pragma once

#include <span>

#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/evaluation/material_truth.h"
#include "pliant/evaluation/track_scores.h"
#include "pliant/scene/pixel_track.h"

namespace pliant {

// `without_truth`: the tracks that start where there is no material, or in the last frame.
struct TrackError : TrackScores {
  double survival = 0;
  double median_px = 0;  // distance of the seen pixels of truly visible points, in pixels of the image itself
};

// `frames` ascend: those in which the tracks could have been followed. Fails as the truth does, and with kInsufficient
// where no track has a material point that is visible in a later frame.
Result<TrackError> ComputeTrackError(std::span<const PixelTrack> tracks, std::span<const int> frames,
                                     const Camera& camera, MaterialTruth& truth);

}  // namespace pliant
