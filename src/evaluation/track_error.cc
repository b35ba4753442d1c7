// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/track_error.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/track_scoring.h"
#include "pliant/base/statistics.h"

namespace pliant {
namespace {

constexpr double kScored_px = 256;  // both sides of the images that distances are measured in
constexpr double kFailed_px = 50;

// A track on its way through the frames.
struct ScoredTrack {
  const PixelTrack* track;
  int frames = 0;  // after its first
  int passed = 0;  // before it failed
  bool failed = false;
};

const TrackPixel* FirstSeen(const PixelTrack& track) {
  const auto first = std::ranges::find(track.pixels, true, &TrackPixel::visible);
  return first == track.pixels.end() ? nullptr : &*first;
}

// One track in one frame, in which it is `pixel`, or null, and its material point `truth`. Adds the distance of a seen
// pixel of a truly visible point, in the image.
void CountPixel(const TrackPixel* pixel, const MaterialState& truth, const Camera& camera, ScoredTrack* track,
                TrackCounts* counts, std::vector<double>* distances_px) {
  ScoredPoint point{.visible = IsTrulyVisible(truth), .seen = pixel != nullptr && pixel->visible, .distance_px = {}};
  if (point.visible && pixel != nullptr) {
    const Eigen::Vector2d off = pixel->pixel - *truth.pixel;
    point.distance_px = kScored_px * Eigen::Vector2d(off.x() / camera.width(), off.y() / camera.height()).norm();
    if (point.seen) distances_px->push_back(off.norm());
  }
  counts->Add(point);
  if (point.visible && !(point.distance_px && *point.distance_px < kFailed_px)) track->failed = true;
  ++track->frames;
  if (!track->failed) ++track->passed;
}

}  // namespace

Result<TrackError> ComputeTrackError(std::span<const PixelTrack> tracks, std::span<const int> frames,
                                     const Camera& camera, MaterialTruth& truth) {
  std::vector<TrackQuery> queries;
  std::vector<ScoredTrack> scored;
  for (const PixelTrack& track : tracks) {
    const TrackPixel* first = FirstSeen(track);
    if (first == nullptr) continue;
    queries.push_back({first->frame_idx, first->pixel});
    scored.push_back({.track = &track});
  }
  TrackCounts counts;
  std::vector<double> distances_px;
  const auto visit = [&](std::size_t k, int frame_idx, const MaterialState& state) {
    if (frame_idx == queries[k].frame_idx) return;
    CountPixel(PixelIn(*scored[k].track, frame_idx), state, camera, &scored[k], &counts, &distances_px);
  };
  if (Status status = VisitMaterial(queries, frames, truth, visit); !status.ok()) return status;
  if (counts.visible == 0)
    return Status(ErrorCode::kInsufficient,
                  "none of the " + std::to_string(tracks.size()) +
                      " tracks starts on a point whose true path is visible in a later frame");
  std::vector<double> survivals;
  for (const ScoredTrack& track : scored)
    if (track.frames > 0) survivals.push_back(ShareOf(track.passed, track.frames));
  TrackError error{counts.Scores(survivals.size(), tracks.size())};
  error.survival = Mean(survivals);
  error.median_px = Median(std::move(distances_px));
  return error;
}

}  // namespace pliant
