// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/track_error.h"

#include <map>
#include <optional>
#include <vector>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

constexpr double kScored_px = 256;  // both sides of the images that distances are measured in
constexpr double kFailed_px = 50;
constexpr std::size_t kNumDistances = TrackError::kDistances_px.size();

// A track on its way through the frames.
struct ScoredTrack {
  const PixelTrack* track;
  MaterialId material;
  int frames = 0;  // after its first
  int passed = 0;  // before it failed
  bool failed = false;
};

struct TrackCounts {
  std::int64_t points = 0;
  std::int64_t visible = 0;
  std::int64_t right_visibility = 0;
  std::array<std::int64_t, kNumDistances> within = {};
  std::array<std::int64_t, kNumDistances> true_positives = {};
  std::array<std::int64_t, kNumDistances> false_positives = {};
  std::vector<double> distances_px;  // of seen pixels of truly visible points, in the image
};

const TrackPixel* FirstSeen(const PixelTrack& track) {
  const auto first = std::ranges::find(track.pixels, true, &TrackPixel::visible);
  return first == track.pixels.end() ? nullptr : &*first;
}

// One track in one frame, in which it is `pixel`, or null, and its material point `truth`.
void CountPoint(const TrackPixel* pixel, const MaterialState& truth, const Camera& camera, ScoredTrack* track,
                TrackCounts* counts) {
  const bool visible = truth.visibility == MaterialVisibility::kVisible && truth.pixel.has_value();
  const bool seen = pixel != nullptr && pixel->visible;
  std::optional<double> distance;  // in the scored image
  if (visible && pixel != nullptr) {
    const Eigen::Vector2d off = pixel->pixel - *truth.pixel;
    distance = kScored_px * Eigen::Vector2d(off.x() / camera.width(), off.y() / camera.height()).norm();
    if (seen) counts->distances_px.push_back(off.norm());
  }
  ++counts->points;
  if (visible) ++counts->visible;
  if (visible == seen) ++counts->right_visibility;
  for (std::size_t k = 0; k < kNumDistances; ++k) {
    const bool is_near = distance && *distance < TrackError::kDistances_px[k];
    if (is_near) ++counts->within[k];
    if (seen) ++(is_near ? counts->true_positives : counts->false_positives)[k];
  }
  if (visible && !(distance && *distance < kFailed_px)) track->failed = true;
  ++track->frames;
  if (!track->failed) ++track->passed;
}

Status CountFrame(int frame_idx, const Camera& camera, MaterialTruth& truth, std::vector<ScoredTrack>* tracks,
                  TrackCounts* counts) {
  std::vector<MaterialId> materials;
  for (const ScoredTrack& track : *tracks) materials.push_back(track.material);
  const auto states = truth.Observe(frame_idx, materials);
  if (!states.ok()) return states.status();
  for (std::size_t k = 0; k < tracks->size(); ++k)
    if ((*states)[k]) CountPoint(PixelIn(*(*tracks)[k].track, frame_idx), *(*states)[k], camera, &(*tracks)[k], counts);
  return Status::Ok();
}

// The tracks that begin in a frame, of which those without a material point are none.
Status BeginTracks(int frame_idx, const std::vector<const PixelTrack*>& begin, MaterialTruth& truth,
                   std::vector<ScoredTrack>* tracks) {
  std::vector<Eigen::Vector2d> pixels;
  for (const PixelTrack* track : begin) pixels.push_back(FirstSeen(*track)->pixel);
  const auto materials = truth.PointsAt(frame_idx, pixels);
  if (!materials.ok()) return materials.status();
  for (std::size_t k = 0; k < begin.size(); ++k)
    if ((*materials)[k]) tracks->push_back({.track = begin[k], .material = *(*materials)[k]});
  return Status::Ok();
}

double Share(std::int64_t part, std::int64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

TrackError ErrorOf(const std::vector<ScoredTrack>& tracks, std::size_t all, TrackCounts counts) {
  TrackError error;
  std::vector<double> survivals;
  for (const ScoredTrack& track : tracks)
    if (track.frames > 0) survivals.push_back(Share(track.passed, track.frames));
  error.tracks = static_cast<int>(survivals.size());
  error.without_truth = static_cast<int>(all) - error.tracks;
  error.points = counts.points;
  error.visible = counts.visible;
  error.occlusion_accuracy = Share(counts.right_visibility, counts.points);
  for (std::size_t k = 0; k < kNumDistances; ++k) {
    error.within[k] = Share(counts.within[k], counts.visible);
    error.jaccard[k] = Share(counts.true_positives[k], counts.visible + counts.false_positives[k]);
    error.average_within += error.within[k] / kNumDistances;
    error.average_jaccard += error.jaccard[k] / kNumDistances;
  }
  error.survival = Mean(survivals);
  error.median_px = counts.distances_px.empty() ? 0 : Median(std::move(counts.distances_px));
  return error;
}

}  // namespace

Result<TrackError> ComputeTrackError(std::span<const PixelTrack> tracks, std::span<const int> frames,
                                     const Camera& camera, MaterialTruth& truth) {
  std::map<int, std::vector<const PixelTrack*>> begin;
  for (const PixelTrack& track : tracks)
    if (const TrackPixel* first = FirstSeen(track); first != nullptr) begin[first->frame_idx].push_back(&track);
  std::vector<ScoredTrack> scored;
  TrackCounts counts;
  for (const int frame_idx : frames) {
    if (Status status = CountFrame(frame_idx, camera, truth, &scored, &counts); !status.ok()) return status;
    const auto found = begin.find(frame_idx);
    if (found == begin.end()) continue;
    if (Status status = BeginTracks(frame_idx, found->second, truth, &scored); !status.ok()) return status;
  }
  if (counts.visible == 0)
    return Status(ErrorCode::kInsufficient,
                  "none of the " + std::to_string(tracks.size()) +
                      " tracks starts on a point whose true path is visible in a later frame");
  return ErrorOf(scored, tracks.size(), std::move(counts));
}

}  // namespace pliant
