// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/submap/candidates.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "pliant/base/statistics.h"
#include "tracking/serialize.h"
#include "tracking/submap/surface_distances.h"

namespace pliant {
namespace {

constexpr std::size_t kSolvedViews = 10;  // at most, spread evenly
constexpr std::size_t kMinAnchors = 3;    // fewer that are left: others are chosen

}  // namespace

std::vector<CandidateTrack> Candidates::tracks() const {
  std::vector<CandidateTrack> tracks;
  for (const auto& [id, point] : points_) tracks.push_back(point.track);
  return tracks;
}

std::vector<Eigen::Vector2d> Candidates::FollowedPixels() const {
  std::vector<Eigen::Vector2d> pixels;
  for (const auto& [id, point] : points_)
    if (point.track.followed) pixels.push_back(point.track.pixel);
  return pixels;
}

// The landmarks nearest to it in the image.
void Candidates::ChooseAnchors(const Map& map, Point* point) const {
  std::vector<std::pair<double, const Landmark*>> nearest;
  for (const Landmark& landmark : map.landmarks)
    nearest.emplace_back((landmark.pixel - point->track.pixel).squaredNorm(), &landmark);
  const auto count = std::min(nearest.size(), static_cast<std::size_t>(options_.neighbors));
  std::partial_sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(count), nearest.end());
  nearest.resize(count);
  point->anchors.clear();
  point->anchored_at.setZero();
  for (const auto& [squared_distance, landmark] : nearest) {
    point->anchors.push_back({landmark->id, landmark->position});
    point->anchored_at += landmark->position / static_cast<double>(count);
  }
}

// (G1, G2); nothing when too few anchors are left.
std::optional<Candidates::Displacement> Candidates::SinceAnchors(const Point& point, const Map& map) const {
  std::vector<Eigen::Vector3d> displacements;
  std::vector<Eigen::Vector3d> positions;
  for (const Anchor& anchor : point.anchors)
    if (const Landmark* landmark = map.Find(anchor.id); landmark != nullptr) {
      displacements.emplace_back(landmark->position - anchor.position);
      positions.push_back(anchor.position);
    }
  if (positions.size() < kMinAnchors) return std::nullopt;
  const auto count = static_cast<double>(positions.size());
  Displacement since;
  for (const Eigen::Vector3d& displacement : displacements) since.mean += displacement / count;
  double squares = 0;
  double gradients = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    squares += (displacements[i] - since.mean).squaredNorm();
    for (std::size_t j = 0; j < i; ++j)
      gradients += (displacements[i] - displacements[j]).squaredNorm() /
                   std::max(1e-6, (positions[i] - positions[j]).squaredNorm());
  }
  since.sigma = std::sqrt(squares / (3.0 * count));
  since.gradient = std::sqrt(gradients / (0.5 * count * (count - 1.0)));
  return since;
}

// One more view, at its pixel. False where there is no ray, or nothing to hold it by.
bool Candidates::AppendView(const Rigid3& cam_from_world, const Map& map, Point* point) const {
  const auto ray = camera_.Unproject(point->track.pixel);
  if (!ray) return false;
  auto since = SinceAnchors(*point, map);
  if (!since) {
    if (!point->displacements.empty()) point->before = point->displacements.back();
    ChooseAnchors(map, point);
    if (point->anchors.size() < kMinAnchors) return false;
    since = Displacement();
  }
  point->cams_from_world.push_back(cam_from_world);
  point->rays.push_back(*ray);
  point->displacements.push_back({point->before.mean + since->mean, std::hypot(point->before.sigma, since->sigma),
                                  std::hypot(point->before.gradient, since->gradient)});
  return true;
}

bool Candidates::Add(const CandidateTrack& track, const Rigid3& cam_from_world, const Map& map) {
  Point point;
  point.track = track;
  if (!AppendView(cam_from_world, map, &point)) return false;
  std::vector<double> distances;
  for (const Anchor& anchor : point.anchors) distances.push_back((cam_from_world * anchor.position).norm());
  point.position = cam_from_world.Inverse() * Eigen::Vector3d(Median(std::move(distances)) * point.rays.front());
  points_[track.id] = std::move(point);
  return true;
}

std::vector<PointPrediction> Candidates::Predict(const Rigid3& cam_from_world) const {
  std::vector<Eigen::Vector2d> from;
  std::vector<Eigen::Vector2d> to;
  for (const auto& [id, point] : points_) {
    const auto before = camera_.Project(point.cams_from_world.back() * point.position);
    const auto now = camera_.Project(cam_from_world * point.position);
    from.push_back(point.track.pixel);
    to.push_back(before && now ? Eigen::Vector2d(point.track.pixel + *now - *before) : point.track.pixel);
  }
  const std::vector<Eigen::Matrix2d> affines = NeighborhoodAffines(from, to);
  std::vector<PointPrediction> predictions;
  for (const auto& [id, point] : points_)
    predictions.push_back({id, to[predictions.size()], affines[predictions.size()]});
  return predictions;
}

void Candidates::TakeCorrection(const Map& before, const Map& after) {
  for (auto& [id, point] : points_)
    for (Anchor& anchor : point.anchors) {
      const Landmark* from = before.Find(anchor.id);
      const Landmark* to = after.Find(anchor.id);
      if (from != nullptr && to != nullptr) anchor.position += to->position - from->position;
    }
}

void Candidates::Move(const Rigid3& motion) {
  const Rigid3 back = motion.Inverse();
  for (auto& [id, point] : points_) {
    point.position = motion * point.position;
    for (Rigid3& pose : point.cams_from_world) pose = pose * back;
    for (Displacement& displacement : point.displacements) displacement.mean = motion.rotation * displacement.mean;
    for (Anchor& anchor : point.anchors) anchor.position = motion * anchor.position;
    point.anchored_at = motion * point.anchored_at;
    point.before.mean = motion.rotation * point.before.mean;
  }
}

bool Candidates::AddView(const PointTrack& track, const Rigid3& cam_from_world, const Map& map) {
  Point& point = points_.at(track.id);
  point.track.pixel = track.pixel;
  point.track.ssim = track.ssim;
  point.track.followed = true;
  if (static_cast<int>(point.rays.size()) < options_.max_views && AppendView(cam_from_world, map, &point)) return true;
  points_.erase(track.id);
  return false;
}

// (G3), from its best guess, by at most kSolvedViews of its views.
Result<MovingPoint> Candidates::Triangulate(const Point& point, const std::optional<DistancePrior>& surface) const {
  const double away = (point.position - point.anchored_at).norm();
  const std::size_t count = std::min(point.rays.size(), kSolvedViews);
  std::vector<MovingPointView> views;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t view = k * (point.rays.size() - 1) / (count - 1);
    const Displacement& displacement = point.displacements[view];
    views.push_back({point.cams_from_world[view], point.rays[view], displacement.mean,
                     std::hypot(displacement.sigma, away * displacement.gradient)});
  }
  const Eigen::Vector3d first = point.position - point.displacements.back().mean;
  return TriangulateMovingPoint(views, (point.cams_from_world.front() * first).norm(),
                                options_.noise_px / camera_.MeanFocalLengthPx(), surface);
}

// Moves its best guess to where its views say, and the surface where it says something; infinite errors where nothing
// does.
MovingPoint Candidates::MoveGuess(const std::optional<DistancePrior>& surface, Point* point) const {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const auto placed = Triangulate(*point, surface);
  if (!placed.ok()) return {.log_distance_sigma = kNone, .rms = kNone};
  point->position = placed->position + point->displacements.back().mean;
  return *placed;
}

std::vector<Candidates::CertainPoint> Candidates::Certain(const Rigid3& cam_from_world, const Map& map,
                                                          double map_depth_sigma) {
  std::vector<double> distances;
  for (const Landmark& landmark : map.landmarks) distances.push_back((cam_from_world * landmark.position).norm());
  if (distances.empty()) return {};
  const double median_distance = Median(std::move(distances));
  // A map that runs short of points takes less certain ones, rather than be lost.
  constexpr double kMaxSlack = 3;
  const double slack = std::clamp(options_.scarce_points / static_cast<double>(map.landmarks.size()), 1.0, kMaxSlack);
  std::vector<std::pair<PointId, MovingPoint>> placed;
  std::vector<double> errors;
  for (auto& [id, point] : points_) {
    if (static_cast<int>(point.rays.size()) < options_.min_views) continue;
    placed.emplace_back(id, MoveGuess({}, &point));
    if (std::isfinite(placed.back().second.rms)) errors.push_back(placed.back().second.rms);
  }
  if (errors.empty()) return {};
  const double max_error = std::min(options_.max_error, options_.max_error_ratio * Median(std::move(errors)));
  const auto is_certain = [&](const MovingPoint& guess, const Point& point, double max_sigma) {
    return guess.rms <= max_error &&
           guess.log_distance_sigma * (cam_from_world * point.position).norm() <= max_sigma * median_distance;
  };
  std::optional<SurfaceDistances> surface;  // where no point can be certain by it, it is not asked
  if (map_depth_sigma > 0.0) surface.emplace(map, cam_from_world, options_.neighbors);
  std::vector<CertainPoint> certain;
  for (const auto& [id, guess] : placed) {
    Point& point = points_.at(id);
    const double max_sigma = slack * options_.max_depth_sigma;
    // What is known of its surroundings' motion depends on how far from them it turned out to be: once more from there.
    if (is_certain(guess, point, max_sigma)) {
      const MovingPoint again = MoveGuess({}, &point);
      if (is_certain(again, point, max_sigma)) certain.push_back({id, point.position, again.log_distance_sigma});
    } else if (const auto prior = surface ? surface->At(point.track.pixel, point.rays.back()) : std::nullopt; prior) {
      const Eigen::Vector3d before = point.position;
      const MovingPoint with_surface = MoveGuess(prior, &point);
      if (is_certain(with_surface, point, map_depth_sigma))
        certain.push_back({id, point.position, with_surface.log_distance_sigma, true});
      else
        point.position = before;
    }
  }
  return certain;
}

std::optional<Landmark> Candidates::AsLandmark(const CertainPoint& certain, const Rigid3& cam_from_world,
                                               const Map& map) const {
  const Point& point = points_.at(certain.id);
  Eigen::Vector3d since_rest = Eigen::Vector3d::Zero();
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();
  double log_sigmas = 0;
  int anchors = 0;
  for (const Anchor& anchor : point.anchors)
    if (const Landmark* landmark = map.Find(anchor.id); landmark != nullptr) {
      since_rest += landmark->position - landmark->rest_position;
      motion += landmark->last_motion;
      log_sigmas += DistanceSigma(*landmark, cam_from_world) / (cam_from_world * landmark->position).norm();
      ++anchors;
    }
  if (anchors == 0) return std::nullopt;
  return Landmark{
      .id = certain.id,
      .rest_position = certain.position - since_rest / anchors,
      .position = certain.position,
      .last_motion = motion / anchors,
      .pixel = point.track.pixel,
      .ssim = point.track.ssim,
      .log_distance_sigma = log_sigmas > 0.0 ? std::hypot(certain.log_distance_sigma, log_sigmas / anchors) : 0.0,
      .determined_at = certain.position,
      .from_surface = certain.from_surface};
}

void Candidates::Serialize(StateArchive& archive) { archive(points_); }
void Candidates::Anchor::Serialize(StateArchive& archive) { archive.Members<2>(*this); }
void Candidates::Displacement::Serialize(StateArchive& archive) { archive.Members<3>(*this); }
void Candidates::Point::Serialize(StateArchive& archive) { archive.Members<8>(*this); }

}  // namespace pliant
