// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/tracks/trackability.h"

#include <algorithm>

#include "tracking/tracks/followed_corners.h"

namespace pliant {

Trackability MeasureTrackability(std::span<const PreparedFrame> frames, const TrackerOptions& options, int threads) {
  if (frames.size() < 2) return {};
  const auto tracks = FollowCorners(frames, options, threads);
  const auto alive = std::ranges::count_if(tracks, [&](const auto& track) { return track.size() == frames.size(); });
  return {static_cast<int>(tracks.size()), static_cast<int>(alive)};
}

}  // namespace pliant
