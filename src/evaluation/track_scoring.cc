// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "evaluation/track_scoring.h"

#include <map>
#include <vector>

namespace pliant {

Status VisitMaterial(std::span<const TrackQuery> queries, std::span<const int> frames, MaterialTruth& truth,
                     const VisitTrackTruth& visit) {
  std::map<int, std::vector<std::size_t>> beginning;  // by frame
  for (std::size_t k = 0; k < queries.size(); ++k) beginning[queries[k].frame_idx].push_back(k);
  std::vector<std::size_t> followed;
  std::vector<MaterialId> materials;
  for (const int frame_idx : frames) {
    if (const auto found = beginning.find(frame_idx); found != beginning.end()) {
      std::vector<Eigen::Vector2d> pixels;
      for (const std::size_t k : found->second) pixels.push_back(queries[k].pixel);
      const auto ids = truth.PointsAt(frame_idx, pixels);
      if (!ids.ok()) return ids.status();
      for (std::size_t i = 0; i < ids->size(); ++i) {
        if (!(*ids)[i]) continue;
        followed.push_back(found->second[i]);
        materials.push_back(*(*ids)[i]);
      }
    }
    const auto states = truth.Observe(frame_idx, materials);
    if (!states.ok()) return states.status();
    for (std::size_t i = 0; i < followed.size(); ++i)
      if ((*states)[i]) visit(followed[i], frame_idx, *(*states)[i]);
  }
  return Status::Ok();
}

bool IsTrulyVisible(const MaterialState& truth) {
  return truth.visibility == MaterialVisibility::kVisible && truth.pixel.has_value();
}

void TrackCounts::Add(const ScoredPoint& point) {
  ++points;
  if (point.visible) ++visible;
  if (point.visible == point.seen) ++right_visibility;
  for (std::size_t k = 0; k < TrackScores::kDistances_px.size(); ++k) {
    const bool is_near = point.distance_px && *point.distance_px < TrackScores::kDistances_px[k];
    if (is_near) ++within[k];
    if (point.seen) ++(is_near ? true_positives : false_positives)[k];
  }
}

TrackScores TrackCounts::Scores(std::size_t tracks, std::size_t all) const {
  TrackScores scores;
  scores.tracks = static_cast<int>(tracks);
  scores.without_truth = static_cast<int>(all - tracks);
  scores.points = points;
  scores.visible = visible;
  scores.occlusion_accuracy = ShareOf(right_visibility, points);
  for (std::size_t k = 0; k < TrackScores::kDistances_px.size(); ++k) {
    scores.within[k] = ShareOf(within[k], visible);
    scores.jaccard[k] = ShareOf(true_positives[k], visible + false_positives[k]);
    scores.average_within += scores.within[k] / TrackScores::kDistances_px.size();
    scores.average_jaccard += scores.jaccard[k] / TrackScores::kDistances_px.size();
  }
  return scores;
}

double ShareOf(std::int64_t part, std::int64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace pliant
