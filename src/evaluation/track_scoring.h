// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the errors of tracks in the images and in space have in common: the walk along the true paths, and the counts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "pliant/base/status.h"
#include "pliant/evaluation/material_truth.h"
#include "pliant/evaluation/track_scores.h"

namespace pliant {

// Where a track is first seen.
struct TrackQuery {
  int frame_idx = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

using VisitTrackTruth = std::function<void(std::size_t query_idx, int frame_idx, const MaterialState& truth)>;

// Visits every query that shows a material point, in each of the `frames`, which ascend, from its own on in which the
// truth knows the point. Fails as the truth.
Status VisitMaterial(std::span<const TrackQuery> queries, std::span<const int> frames, MaterialTruth& truth,
                     const VisitTrackTruth& visit);

bool IsTrulyVisible(const MaterialState& truth);

// One track in one frame.
struct ScoredPoint {
  bool visible = false;               // in truth
  bool seen = false;                  // by the track
  std::optional<double> distance_px;  // of the estimate from the truth; nothing: hidden in truth, or no estimate
};

struct TrackCounts {
  std::int64_t points = 0;
  std::int64_t visible = 0;
  std::int64_t right_visibility = 0;
  std::array<std::int64_t, TrackScores::kDistances_px.size()> within = {};
  std::array<std::int64_t, TrackScores::kDistances_px.size()> true_positives = {};
  std::array<std::int64_t, TrackScores::kDistances_px.size()> false_positives = {};

  void Add(const ScoredPoint& point);
  // `tracks` of `all` have a point that counts.
  TrackScores Scores(std::size_t tracks, std::size_t all) const;
};

// None of `whole` is no share.
double ShareOf(std::int64_t part, std::int64_t whole);

}  // namespace pliant
