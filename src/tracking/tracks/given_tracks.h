// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Tracks of another program, as a source of tracks: all of their pixels are known from the start. A point has the id of
// its track where that is not taken, else one above all ids of tracks: so where a track is begun once more, since a
// reference or a map came to nothing, or in another submap, and all new points of a source that goes on with the points
// of another one.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "pliant/scene/pixel_track.h"
#include "pliant/tracking/tracks/track_source.h"

namespace pliant {

class GivenTracks : public TrackSource {
 public:
  // `tracks`, sorted by id, must outlive this.
  explicit GivenTracks(std::span<const PixelTrack> tracks);

  TrackAbilities abilities() const override { return {.tracks_blurred = false, .adds_always = true}; }
  // The tracks that are seen in this image at usable pixels, and off contours unless there are few; those that are seen
  // longest come first.
  std::vector<NewTrack> AddNew(const PreparedFrame& frame, std::span<const Eigen::Vector2d> existing,
                               const CornerOptions& corners) override;
  // The track that is seen nearest to the pixel, half a pixel away at most.
  std::optional<PointId> Add(const Eigen::Vector2d& pixel, const PreparedFrame& frame) override;
  bool Resume(PointId id, const Eigen::Vector2d& pixel, const PreparedFrame& frame) override;
  PointId next_id() const override { return PointId{next_id_}; }
  void SkipIds(PointId next) override { next_id_ = std::max(next_id_, next.value); }
  void Remove(PointId) override {}  // what it was is kept, so that it can be resumed
  std::vector<PointTrack> Track(const PreparedFrame& previous, const PreparedFrame& current,
                                std::span<const PointPrediction> predictions) override;
  std::vector<PointTrack> Find(const PreparedFrame& current, std::span<const PointPrediction> predictions) override;
  void Keep(std::span<const PointId>) override {}
  std::vector<PointTrack> TrackIntoBlur(const PreparedFrame& previous, const PreparedFrame& blurred,
                                        std::span<const PointPrediction> predictions) const override;
  bool IsSerializable() const override { return true; }
  void Serialize(StateArchive& archive) override;

 private:
  const PixelTrack* Nearest(const Eigen::Vector2d& pixel, int frame_idx) const;
  PointId Begin(const PixelTrack& track);
  std::vector<PointTrack> Locate(int frame_idx, std::span<const PointPrediction> predictions) const;

  std::span<const PixelTrack> tracks_;
  std::map<PointId, const PixelTrack*> followed_;  // every point that there ever was
  std::int64_t next_id_;                           // of a point that cannot have the id of its track
  bool takes_ids_of_tracks_ = true;
};

}  // namespace pliant
