// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/bootstrapping/reference_tracks.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "tracking/depth_prior/prior_distances.h"
#include "tracking/serialize.h"

namespace pliant {

Reference ReferenceTracks::Take(const PreparedFrame& frame) {
  Reference reference;
  reference.frames.push_back({frame.frame_idx, {}});
  const LocalBrightness brightness(frame.image, frame.mask.valid());
  if (initializer_->TakesKnownPoints())
    AddKnownPoints(frame, brightness, &reference);
  else
    AddCorners(frame, brightness, options_.corners.max_corners, &reference.frames.front());
  return reference;
}

bool ReferenceTracks::CanOverlap() const {
  const TrackAbilities abilities = tracks_->abilities();
  return initializer_->TakesLaterPoints() && abilities.adds_points && !abilities.adds_always;
}

void ReferenceTracks::Follow(const PreparedFrame& previous, const PreparedFrame& frame, Reference* first,
                             Reference* second, LossCounts* losses) {
  std::vector<PointPrediction> predictions = PredictPixels(*first, frame.frame_idx);
  const std::size_t of_first = predictions.size();
  if (second->IsThere()) std::ranges::copy(PredictPixels(*second, frame.frame_idx), std::back_inserter(predictions));
  const std::vector<PointTrack> tracks = tracks_->Track(previous, frame, predictions);
  const std::span<const PointTrack> all(tracks);
  first->frames.push_back(FollowedFrame(frame, all.first(of_first), first->frames.size(), losses));
  if (!second->IsThere()) return;
  LossCounts not_counted;
  second->frames.push_back(FollowedFrame(frame, all.subspan(of_first), second->frames.size(), &not_counted));
}

void ReferenceTracks::Drop(Reference* reference) {
  if (reference->IsThere())
    for (const InitObservation& seen : reference->frames.back().observations) tracks_->Remove(seen.id);
  *reference = {};
}

// Constant velocity in the image: there is no map yet.
std::vector<PointPrediction> ReferenceTracks::PredictPixels(const Reference& reference, int frame_idx) const {
  const std::vector<InitFrame>& frames = reference.frames;
  const std::vector<InitObservation>& last = frames.back().observations;
  const std::vector<Eigen::Vector2d> from = PixelsOf(last);
  std::vector<Eigen::Vector2d> to = from;
  if (frames.size() >= 2) {
    const InitFrame& earlier = frames[frames.size() - 2];
    const double steps =
        static_cast<double>(frame_idx - frames.back().frame_idx) / (frames.back().frame_idx - earlier.frame_idx);
    for (std::size_t k = 0; k < last.size(); ++k)
      if (const InitObservation* before = FindById(earlier.observations, last[k].id); before != nullptr)
        to[k] = (1 + steps) * last[k].pixel - steps * before->pixel;
  }
  const std::vector<Eigen::Matrix2d> affines = NeighborhoodAffines(from, to);
  std::vector<PointPrediction> predictions;
  for (std::size_t k = 0; k < last.size(); ++k) predictions.push_back({last[k].id, to[k], affines[k]});
  return predictions;
}

// A reference's points in this frame, and every Nth frame, or whenever the source has them, new ones where there are
// none.
InitFrame ReferenceTracks::FollowedFrame(const PreparedFrame& frame, std::span<const PointTrack> followed,
                                         std::size_t frames_before, LossCounts* losses) {
  InitFrame result{frame.frame_idx, {}};
  const LocalBrightness brightness(frame.image, frame.mask.valid());
  const PriorDistances prior(frame, camera_, options_.depth_prior);
  std::vector<PointId> kept;
  for (const PointTrack& track : followed) {
    if (track.failure == PatchFailure::kNone) {
      result.observations.push_back({track.id, track.pixel, track.ssim, brightness.At(track.pixel),
                                     ColorAt(frame.image, track.pixel), prior.LogAt(track.pixel)});
      kept.push_back(track.id);
    } else {
      tracks_->Remove(track.id);
      // The source knows no more of what a map rejects that catches up.
      if (track.failure != PatchFailure::kUnknownPoint) losses->Add(EnumName(track.failure), 1);
    }
  }
  tracks_->Keep(kept);
  const bool is_due =
      tracks_->abilities().adds_always || frames_before % static_cast<std::size_t>(options_.top_up_frames) == 0;
  if (initializer_->TakesLaterPoints() && is_due)
    AddCorners(frame, brightness, options_.corners.max_corners - static_cast<int>(kept.size()), &result);
  return result;
}

// Adds new points away from those that are there.
void ReferenceTracks::AddCorners(const PreparedFrame& frame, const LocalBrightness& brightness, int max_corners,
                                 InitFrame* points) {
  if (max_corners <= 0) return;
  const std::vector<Eigen::Vector2d> existing = PixelsOf(points->observations);
  CornerOptions corners = options_.corners;
  corners.max_corners = max_corners;
  const PriorDistances prior(frame, camera_, options_.depth_prior);
  for (const NewTrack& track : tracks_->AddNew(frame, existing, corners))
    points->observations.push_back({track.id, track.pixel, 1.0, brightness.At(track.pixel),
                                    ColorAt(frame.image, track.pixel), prior.LogAt(track.pixel)});
  std::ranges::sort(points->observations, {}, &InitObservation::id);
}

void ReferenceTracks::AddKnownPoints(const PreparedFrame& frame, const LocalBrightness& brightness,
                                     Reference* reference) {
  if (!frame.known_points) return;
  std::vector<std::pair<InitObservation, double>> added;
  for (const PixelDepth& known : frame.known_points()) {
    if (static_cast<int>(added.size()) == options_.corners.max_corners) break;
    const auto id = tracks_->Add(known.pixel, frame);
    if (!id) continue;
    added.push_back(
        {{*id, known.pixel, 1.0, brightness.At(known.pixel), ColorAt(frame.image, known.pixel)}, known.depth});
  }
  std::ranges::sort(added, {}, [](const auto& point) { return point.first.id; });
  for (const auto& [observation, depth] : added) {
    reference->frames.front().observations.push_back(observation);
    reference->known_depths.push_back(depth);
  }
}

void Reference::Serialize(StateArchive& archive) { archive.Members<5>(*this); }

}  // namespace pliant
