// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/tracks/make_track_source.h"

#include "tracking/tracks/given_tracks.h"
#include "tracking/tracks/oracle_tracks.h"
#include "tracking/tracks/patch_tracks.h"

namespace pliant {

std::unique_ptr<TrackSource> MakeTrackSource(const TrackerOptions& options, std::uint64_t seed, int threads,
                                             const TrackerInputs& inputs) {
  if (inputs.extensions.make_tracks) return inputs.extensions.make_tracks();
  if (!inputs.tracks.empty()) return std::make_unique<GivenTracks>(inputs.tracks);
  if (options.oracle.tracks == Switch::kOn)
    return std::make_unique<OracleTracks>(inputs.truth, options.point_tracker.lucas_kanade,
                                          options.oracle.track_noise_px, Random(seed).Child("oracle tracks"));
  return std::make_unique<PatchTracks>(options.point_tracker, threads);
}

}  // namespace pliant
