// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/tracks/followed_corners.h"

#include <map>

#include "tracking/tracks/patch_tracks.h"

namespace pliant {

std::vector<std::vector<Eigen::Vector2d>> FollowCorners(std::span<const PreparedFrame> frames,
                                                        const TrackerOptions& options, int threads) {
  if (frames.empty()) return {};
  const PreparedFrame& first = frames.front();
  PatchTracks tracks(options.point_tracker, threads);
  std::vector<PointPrediction> predictions;
  std::map<PointId, std::vector<Eigen::Vector2d>> pixels;
  for (const NewTrack& track : tracks.AddNew(first, {}, options.corners)) {
    predictions.push_back({track.id, track.pixel, Eigen::Matrix2d::Identity()});
    pixels[track.id] = {track.pixel};
  }
  for (std::size_t k = 1; k < frames.size(); ++k) {
    std::vector<PointPrediction> next;
    std::vector<PointId> kept;
    for (const PointTrack& track : tracks.Track(frames[k - 1], frames[k], predictions)) {
      if (track.failure != PatchFailure::kNone) continue;
      kept.push_back(track.id);
      next.push_back({track.id, 2 * track.pixel - pixels[track.id].back(), Eigen::Matrix2d::Identity()});
      pixels[track.id].push_back(track.pixel);
    }
    tracks.Keep(kept);
    predictions = std::move(next);
  }
  std::vector<std::vector<Eigen::Vector2d>> followed;
  for (auto& [id, track] : pixels) followed.push_back(std::move(track));
  return followed;
}

}  // namespace pliant
