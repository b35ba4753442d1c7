// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How well the corners of an image can be tracked: measured on a few images of a recording, it tells how far they have
// to be resized and smoothed, and how large patches have to be (WorkingImage).
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "pliant/tracking/prepared_frame.h"
#include "pliant/tracking/tracker_options.h"

namespace pliant {

struct Trackability {
  int corners = 0;  // of the first image that can be tracked at all
  int alive = 0;    // of them, tracked from image to image into the last one
  // One a corner: its pixels in the images, as far as it was tracked.
  std::vector<std::vector<Eigen::Vector2d>> tracks = {};
};

// Tracks the corners of the first frame through the others, each predicted at constant velocity. All 0 for fewer than
// two frames. The result does not depend on `threads`.
Trackability MeasureTrackability(std::span<const PreparedFrame> frames, const TrackerOptions& options, int threads);

// What the tracks of several runs of images tell of a motion, 1/px^2: 1 / (noise^2 + 0.01^2) for each of the alive
// ones, with the TrackNoise of all in px of the source, of which the images are `scale` (> 0) times as large. 0 where
// no run has TrackResiduals. Source: docs/method.md (P14).
double TrackInformation(std::span<const Trackability> runs, double scale);

}  // namespace pliant
