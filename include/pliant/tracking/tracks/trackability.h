// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How well the corners of an image can be tracked: measured on a few images of a recording, it tells how far they have
// to be resized and smoothed (WorkingImage).
#pragma once

#include <span>

#include "pliant/tracking/prepared_frame.h"
#include "pliant/tracking/tracker_options.h"

namespace pliant {

struct Trackability {
  int corners = 0;  // of the first image that can be tracked at all
  int alive = 0;    // of them, tracked from image to image into the last one
};

// Tracks the corners of the first frame through the others, each predicted at constant velocity. All 0 for fewer than
// two frames. The result does not depend on `threads`.
Trackability MeasureTrackability(std::span<const PreparedFrame> frames, const TrackerOptions& options, int threads);

}  // namespace pliant
