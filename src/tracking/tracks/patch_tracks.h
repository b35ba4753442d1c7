// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Point tracks by our own Lucas-Kanade tracker, as a source of tracks.
#pragma once

#include <algorithm>
#include <cstdint>

#include "pliant/tracking/tracks/track_source.h"

namespace pliant {

class PatchTracks : public TrackSource {
 public:
  // `threads` >= 1 follow points; they do not change the result.
  PatchTracks(const PointTrackerOptions& options, int threads)
      : options_(options), threads_(threads), tracker_(options) {}

  TrackAbilities abilities() const override {
    return {.finds_points = options_.patch_policy == PatchPolicy::kAdaptive};
  }
  std::optional<PointId> Add(const Eigen::Vector2d& pixel, const PreparedFrame& frame) override;
  bool Resume(PointId id, const Eigen::Vector2d& pixel, const PreparedFrame& frame) override;
  PointId next_id() const override { return PointId{next_id_}; }
  void SkipIds(PointId next) override { next_id_ = std::max(next_id_, next.value); }
  void Remove(PointId id) override { tracker_.Remove(id); }
  std::vector<PointTrack> Track(const PreparedFrame& previous, const PreparedFrame& current,
                                std::span<const PointPrediction> predictions) override;
  std::vector<PointTrack> Find(const PreparedFrame& current, std::span<const PointPrediction> predictions) override;
  void Keep(std::span<const PointId> ids) override { tracker_.Keep(ids); }
  std::vector<PointTrack> TrackIntoBlur(const PreparedFrame& previous, const PreparedFrame& blurred,
                                        std::span<const PointPrediction> predictions) const override;
  bool IsSerializable() const override { return true; }
  void Serialize(StateArchive& archive) override;

 private:
  PointTrackerOptions options_;
  int threads_;
  PointTracker tracker_;
  std::int64_t next_id_ = 0;
};

}  // namespace pliant
