// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/track_error_3d.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "evaluation/track_scoring.h"
#include "pliant/base/statistics.h"

namespace pliant {
namespace {

constexpr double kScoredSide_px = 256;  // the smaller side of the image whose pixels distances are measured in

// Points and frames, by whether estimate and truth can be compared there.
struct PointsInSpace {
  TrackCounts others;
  std::vector<PointPair> pairs;         // seen and truly visible
  std::vector<Eigen::Vector2d> pixels;  // of these
};

double ScoredFocalLengthPx(const Camera& camera) {
  const double focal = camera.Visit([](const auto& model) { return std::sqrt(model.fx() * model.fy()); });
  return focal * kScoredSide_px / std::min(camera.width(), camera.height());
}

const TrackPoint3d* PointIn(const Track3d& track, int frame_idx) {
  const auto found = std::ranges::lower_bound(track.points, frame_idx, {}, &TrackPoint3d::frame_idx);
  return found != track.points.end() && found->frame_idx == frame_idx ? &*found : nullptr;
}

// `point` may be null.
void AddPointInSpace(const TrackPoint3d* point, const MaterialState& truth, PointsInSpace* points) {
  const bool visible = IsTrulyVisible(truth);
  if (!visible || point == nullptr) {
    points->others.Add({.visible = visible, .seen = point != nullptr, .distance_px = std::nullopt});
    return;
  }
  points->pairs.push_back({point->point_in_cam, truth.point_in_cam});
  points->pixels.push_back(point->pixel);
}

void SetRays(const Camera& camera, PointsInSpace* points) {
  const std::vector<std::optional<Eigen::Vector3d>> rays = camera.Unproject(points->pixels);
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (rays[i] && rays[i]->z() > 0) points->pairs[i].ray = *rays[i] / rays[i]->z();
}

// The quotient of the medians. 1 where there is none.
double MedianScale(const std::vector<PointPair>& pairs, Eigen::Vector3d PointPair::*estimate) {
  std::vector<double> estimated;
  std::vector<double> known;
  for (const PointPair& pair : pairs) {
    if (!(pair.*estimate).allFinite()) continue;
    estimated.push_back((pair.*estimate).norm());
    known.push_back(pair.truth.norm());
  }
  const double median = Median(std::move(estimated));
  return median > 0 ? Median(std::move(known)) / median : 1;
}

TrackCounts CountsInSpace(const PointsInSpace& points, Eigen::Vector3d PointPair::*estimate, double scale,
                          double focal_px) {
  TrackCounts counts = points.others;
  for (const PointPair& pair : points.pairs) {
    const double pixel_mm = std::abs(pair.truth.z()) / focal_px;
    counts.Add(
        {.visible = true, .seen = true, .distance_px = (scale * (pair.*estimate) - pair.truth).norm() / pixel_mm});
  }
  return counts;
}

}  // namespace

Result<TrackError3d> ComputeTrackError3d(std::span<const Track3d> tracks, std::span<const int> frames,
                                         const Camera& camera, MaterialTruth& truth, ErrorScale scale) {
  std::vector<TrackQuery> queries;
  for (const Track3d& track : tracks) queries.push_back({track.points.front().frame_idx, track.points.front().pixel});
  std::vector<bool> known(tracks.size());
  PointsInSpace points;
  const auto visit = [&](std::size_t k, int frame_idx, const MaterialState& state) {
    known[k] = true;
    AddPointInSpace(PointIn(tracks[k], frame_idx), state, &points);
  };
  if (Status status = VisitMaterial(queries, frames, truth, visit); !status.ok()) return status;
  if (points.others.visible == 0 && points.pairs.empty())
    return Status(ErrorCode::kInsufficient, "none of the " + std::to_string(tracks.size()) +
                                                " tracks in space starts on a point whose true path is visible");
  SetRays(camera, &points);
  const auto with_truth = static_cast<std::size_t>(std::ranges::count(known, true));
  const double focal_px = ScoredFocalLengthPx(camera);
  const double s = scale == ErrorScale::kNone ? 1 : MedianScale(points.pairs, &PointPair::estimate);
  TrackError3d error{CountsInSpace(points, &PointPair::estimate, s, focal_px).Scores(with_truth, tracks.size())};
  error.scale = s;
  error.null = CountsInSpace(points, &PointPair::ray, MedianScale(points.pairs, &PointPair::ray), focal_px)
                   .Scores(with_truth, tracks.size());
  std::vector<double> distances_mm;
  for (const PointPair& pair : points.pairs)
    if (pair.estimate.allFinite()) distances_mm.push_back((s * pair.estimate - pair.truth).norm());
  error.median_mm = Median(std::move(distances_mm));
  return error;
}

}  // namespace pliant
