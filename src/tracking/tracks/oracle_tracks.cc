// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/tracks/oracle_tracks.h"

#include <algorithm>
#include <array>
#include <string>

#include "pliant/photometric/patch.h"

namespace pliant {
namespace {

std::vector<PointTrack> AllFailed(std::span<const PointPrediction> predictions) {
  std::vector<PointTrack> tracks;
  for (const PointPrediction& prediction : predictions)
    tracks.push_back({.id = prediction.id, .failure = PatchFailure::kOccluded, .pixel = prediction.pixel});
  return tracks;
}

}  // namespace

std::optional<PointId> OracleTracks::Add(const Eigen::Vector2d& pixel, const PreparedFrame& frame) {
  const PointId id{next_id_};
  if (!Resume(id, pixel, frame)) return std::nullopt;
  return id;
}

bool OracleTracks::Resume(PointId id, const Eigen::Vector2d& pixel, const PreparedFrame& frame) {
  ReferencePatch patch;
  if (CutReferencePatch(frame.pyramid, frame.mask, {pixel.x(), pixel.y()}, options_, AffineSolution::kWithout,
                        &patch) != PatchFailure::kNone)
    return false;
  next_id_ = std::max(next_id_, id.value + 1);
  const std::array<InitObservation, 1> start = {InitObservation{.id = id, .pixel = pixel}};
  return truth_->Follow(frame.frame_idx, start).front() != 0;
}

std::vector<PointTrack> OracleTracks::Track(const PreparedFrame&, const PreparedFrame& current,
                                            std::span<const PointPrediction> predictions) {
  std::vector<PointId> ids;
  for (const PointPrediction& prediction : predictions) ids.push_back(prediction.id);
  std::vector<PointTrack> tracks;
  for (const TrueTrack& located : truth_->Locate(current.frame_idx, ids)) {
    PointTrack track;
    track.id = ids[tracks.size()];
    track.pixel = located.pixel;
    track.ssim = 1;
    if (noise_px_ > 0) {
      Random random = random_.Child(std::to_string(track.id.value) + " " + std::to_string(current.frame_idx));
      for (double& coordinate : track.pixel) coordinate += random.Normal(noise_px_);
    }
    if (located.sight == TrueTrack::Sight::kOccluded) track.failure = PatchFailure::kOccluded;
    if (located.sight == TrueTrack::Sight::kOutsideImage) track.failure = PatchFailure::kOutOfImage;
    tracks.push_back(track);
  }
  return tracks;
}

std::vector<PointTrack> OracleTracks::Find(const PreparedFrame&, std::span<const PointPrediction> predictions) {
  return AllFailed(predictions);
}

std::vector<PointTrack> OracleTracks::TrackIntoBlur(const PreparedFrame&, const PreparedFrame&,
                                                    std::span<const PointPrediction> predictions) const {
  return AllFailed(predictions);
}

}  // namespace pliant
