// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/tracks/trackability.h"

#include <map>
#include <vector>

#include "pliant/image/corners.h"
#include "tracking/tracks/patch_tracks.h"

namespace pliant {

Trackability MeasureTrackability(std::span<const PreparedFrame> frames, const TrackerOptions& options, int threads) {
  if (frames.size() < 2) return {};
  const PreparedFrame& first = frames.front();
  PatchTracks tracks(options.point_tracker, threads);
  std::vector<PointPrediction> predictions;
  std::map<PointId, Eigen::Vector2d> pixels;
  for (const Corner& corner : DetectCorners(first.gray, first.mask.valid(), {}, options.corners)) {
    const auto id = tracks.Add(corner.pixel, first);
    if (!id) continue;
    predictions.push_back({*id, corner.pixel, Eigen::Matrix2d::Identity()});
    pixels[*id] = corner.pixel;
  }
  const auto corners = static_cast<int>(predictions.size());
  for (std::size_t k = 1; k < frames.size(); ++k) {
    std::vector<PointPrediction> next;
    std::vector<PointId> kept;
    for (const PointTrack& track : tracks.Track(frames[k - 1], frames[k], predictions)) {
      if (track.failure != PatchFailure::kNone) continue;
      kept.push_back(track.id);
      next.push_back({track.id, 2 * track.pixel - pixels[track.id], Eigen::Matrix2d::Identity()});
      pixels[track.id] = track.pixel;
    }
    tracks.Keep(kept);
    predictions = std::move(next);
  }
  return {corners, static_cast<int>(predictions.size())};
}

}  // namespace pliant
