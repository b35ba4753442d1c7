// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The source of tracks that the options name.
#pragma once

#include <memory>

#include "pliant/tracking/tracker_options.h"
#include "pliant/tracking/tracks/oracle.h"
#include "pliant/tracking/tracks/track_source.h"

namespace pliant {

// `truth` is asked by the true tracks alone, and must outlive the source. `threads` >= 1 do not change the tracks.
std::unique_ptr<TrackSource> MakeTrackSource(const TrackerOptions& options, int threads, TrackingTruth* truth);

}  // namespace pliant
