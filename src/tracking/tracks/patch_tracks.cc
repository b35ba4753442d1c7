// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/tracks/patch_tracks.h"

#include <algorithm>

#include "pliant/scene/serialize.h"
#include "tracking/tracks/blurred_tracks.h"

namespace pliant {

std::optional<PointId> PatchTracks::Add(const Eigen::Vector2d& pixel, const PreparedFrame& frame) {
  const PointId id{next_id_};
  if (tracker_.Add(id, pixel, frame.pyramid, frame.mask) != PatchFailure::kNone) return std::nullopt;
  ++next_id_;
  return id;
}

bool PatchTracks::Resume(PointId id, const Eigen::Vector2d& pixel, const PreparedFrame& frame) {
  if (tracker_.Add(id, pixel, frame.pyramid, frame.mask) != PatchFailure::kNone) return false;
  next_id_ = std::max(next_id_, id.value + 1);
  return true;
}

std::vector<PointTrack> PatchTracks::Track(const PreparedFrame& previous, const PreparedFrame& current,
                                           std::span<const PointPrediction> predictions) {
  return tracker_.Track(previous.pyramid, previous.mask, current.pyramid, current.mask, predictions, threads_);
}

std::vector<PointTrack> PatchTracks::Find(const PreparedFrame& current, std::span<const PointPrediction> predictions) {
  return tracker_.Find(current.pyramid, current.mask, predictions, threads_);
}

std::vector<PointTrack> PatchTracks::TrackIntoBlur(const PreparedFrame& previous, const PreparedFrame& blurred,
                                                   std::span<const PointPrediction> predictions) const {
  std::vector<Eigen::Vector2d> pixels;
  for (const PointPrediction& prediction : predictions) pixels.push_back(tracker_.PixelOf(prediction.id));
  return pliant::TrackIntoBlur(previous, blurred, pixels, predictions, options_, threads_);
}

void PatchTracks::Serialize(StateArchive& archive) { archive(tracker_, next_id_); }

}  // namespace pliant
