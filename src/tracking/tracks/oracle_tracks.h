// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The true tracks of a simulated scene, as a source of tracks: a point's pixel is that of the material point on which
// it started, for as long as that is visible, with noise where that is wanted.
#pragma once

#include <algorithm>
#include <cstdint>

#include "pliant/base/random.h"
#include "pliant/tracking/tracks/track_source.h"

namespace pliant {

class OracleTracks : public TrackSource {
 public:
  // `truth` must outlive this. `noise_px` is added to each coordinate, from `random`, a point and frame at a time, so
  // that it does not depend on which others are followed. `options` decide at which pixels there is a patch to follow,
  // as with PatchTracks, so that both start from the same points.
  OracleTracks(TrackingTruth* truth, const LucasKanadeOptions& options, double noise_px, const Random& random)
      : truth_(truth), options_(options), noise_px_(noise_px), random_(random) {}

  TrackAbilities abilities() const override {
    return {.adds_points = false, .finds_points = false, .tracks_blurred = false, .sees_appearance = false};
  }
  std::optional<PointId> Add(const Eigen::Vector2d& pixel, const PreparedFrame& frame) override;
  bool Resume(PointId id, const Eigen::Vector2d& pixel, const PreparedFrame& frame) override;
  PointId next_id() const override { return PointId{next_id_}; }
  void SkipIds(PointId next) override { next_id_ = std::max(next_id_, next.value); }
  void Remove(PointId) override {}
  std::vector<PointTrack> Track(const PreparedFrame& previous, const PreparedFrame& current,
                                std::span<const PointPrediction> predictions) override;
  std::vector<PointTrack> Find(const PreparedFrame& current, std::span<const PointPrediction> predictions) override;
  void Keep(std::span<const PointId>) override {}
  std::vector<PointTrack> TrackIntoBlur(const PreparedFrame& previous, const PreparedFrame& blurred,
                                        std::span<const PointPrediction> predictions) const override;

 private:
  TrackingTruth* truth_;
  LucasKanadeOptions options_;
  double noise_px_;
  Random random_;
  std::int64_t next_id_ = 0;
};

}  // namespace pliant
