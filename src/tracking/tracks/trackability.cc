// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/tracks/trackability.h"

#include <algorithm>
#include <utility>

#include "pliant/tracking/tracks/image_statistics.h"
#include "tracking/tracks/followed_corners.h"

namespace pliant {
namespace {

// Images that stand still, or are repeated, have no noise.
constexpr double kMinNoise_px = 0.01;

}  // namespace

Trackability MeasureTrackability(std::span<const PreparedFrame> frames, const TrackerOptions& options, int threads) {
  if (frames.size() < 2) return {};
  auto tracks = FollowCorners(frames, options, threads);
  const auto alive = std::ranges::count_if(tracks, [&](const auto& track) { return track.size() == frames.size(); });
  return {static_cast<int>(tracks.size()), static_cast<int>(alive), std::move(tracks)};
}

double TrackInformation(std::span<const Trackability> runs, double scale) {
  std::vector<double> residuals_px;
  int alive = 0;
  for (const Trackability& run : runs) {
    const std::vector<double> of_run = TrackResiduals(run.tracks);
    residuals_px.insert(residuals_px.end(), of_run.begin(), of_run.end());
    alive += run.alive;
  }
  if (residuals_px.empty()) return 0;
  const double noise_px = TrackNoise(std::move(residuals_px)) / scale;
  return alive / (noise_px * noise_px + kMinNoise_px * kMinNoise_px);
}

}  // namespace pliant
