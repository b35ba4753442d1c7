// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/tracks/make_track_source.h"

#include "tracking/tracks/oracle_tracks.h"
#include "tracking/tracks/patch_tracks.h"

namespace pliant {

std::unique_ptr<TrackSource> MakeTrackSource(const TrackerOptions& options, int threads, TrackingTruth* truth) {
  if (options.oracle.tracks == Switch::kOn)
    return std::make_unique<OracleTracks>(truth, options.point_tracker.lucas_kanade);
  return std::make_unique<PatchTracks>(options.point_tracker, threads);
}

}  // namespace pliant
