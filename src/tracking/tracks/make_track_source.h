// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The source of tracks: the one that is given, or that the options name.
#pragma once

#include <cstdint>
#include <memory>

#include "pliant/tracking/tracker_inputs.h"
#include "pliant/tracking/tracker_options.h"
#include "pliant/tracking/tracks/track_source.h"

namespace pliant {

// `inputs` must outlive the source; the truth is asked by the true tracks alone. `threads` >= 1 do not change the
// tracks, `seed` decides the noise of the true ones.
std::unique_ptr<TrackSource> MakeTrackSource(const TrackerOptions& options, std::uint64_t seed, int threads,
                                             const TrackerInputs& inputs);

}  // namespace pliant
