// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/submap/surface_distances.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

constexpr std::size_t kMinNeighbors = 6;  // twice the unknowns of a plane
constexpr double kMinDeviation = 1e-3;    // tissue is not flatter than that
constexpr double kSmallestGap_px = 8.0;   // gaps are rounded to it times a power of two
constexpr double kOneSigma = 0.683;       // share of errors below it
constexpr std::size_t kMinErrors = 20;    // fewer do not tell their quantile

}  // namespace

SurfaceDistances::SurfaceDistances(const Map& map, const Rigid3& cam_from_world, int neighbors)
    : neighbors_(static_cast<std::size_t>(std::max(neighbors, 0))) {
  for (const Landmark& landmark : map.landmarks) {
    if (landmark.from_surface) continue;
    pixels_.push_back(landmark.pixel);
    points_in_cam_.push_back(cam_from_world * landmark.position);
  }
  nearest_.emplace(pixels_);
}

// By linear least squares of n . x = 1, whose residuals are relative distances from the plane.
std::optional<SurfaceDistances::Plane> SurfaceDistances::PlaneAt(const Eigen::Vector2d& pixel,
                                                                 const Eigen::Vector3d& ray, double gap_px) const {
  const std::vector<NearestInPlane::Neighbor> nearest = nearest_->To(pixel, neighbors_, gap_px);
  const std::size_t count = nearest.size();
  if (count < kMinNeighbors) return std::nullopt;
  Eigen::MatrixX3d points(static_cast<Eigen::Index>(count), 3);
  for (std::size_t k = 0; k < count; ++k)
    points.row(static_cast<Eigen::Index>(k)) = points_in_cam_[nearest[k].index].transpose();
  const Eigen::LDLT<Eigen::Matrix3d> factor(points.transpose() * points);
  if (factor.info() != Eigen::Success || !factor.isPositive()) return std::nullopt;
  const Eigen::Vector3d normal = factor.solve(points.colwise().sum().transpose());
  if (!normal.allFinite()) return std::nullopt;
  const double squares = ((points * normal).array() - 1.0).square().sum();
  Plane plane{.deviation = std::max(kMinDeviation, std::sqrt(squares / static_cast<double>(count - 3))),
              .nearest_px = std::sqrt(nearest.front().squared_distance)};
  const double inverse_distance = normal.dot(ray);
  plane.log_distance = inverse_distance > 0.0 ? -std::log(inverse_distance) : std::numeric_limits<double>::infinity();
  if (!std::isfinite(plane.log_distance)) return plane;
  const Eigen::Vector3d x = ray / inverse_distance;
  plane.leverage_sigma = std::sqrt(1.0 + x.dot(factor.solve(x)));
  if (!std::isfinite(plane.leverage_sigma)) return std::nullopt;
  return plane;
}

// What planes whose points are that far away have to deviate by, for the distances of the map's points to be as wrong
// as they are: the map tells itself how flat it is over which distance.
std::optional<double> SurfaceDistances::DeviationAcross(double gap_px) {
  const auto [entry, is_new] = deviations_.try_emplace(gap_px, std::nullopt);
  if (!is_new) return entry->second;
  std::vector<double> errors;
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const double distance = points_in_cam_[i].norm();
    const auto plane = PlaneAt(pixels_[i], points_in_cam_[i] / distance, gap_px);
    if (plane) errors.push_back(std::abs(plane->log_distance - std::log(distance)) / plane->leverage_sigma);
  }
  if (errors.size() >= kMinErrors) entry->second = Quantile(std::move(errors), kOneSigma);
  return entry->second;
}

std::optional<DistancePrior> SurfaceDistances::At(const Eigen::Vector2d& pixel, const Eigen::Vector3d& ray) {
  const auto plane = PlaneAt(pixel, ray, 0.0);
  if (!plane || !std::isfinite(plane->log_distance)) return std::nullopt;
  const double power = std::max(0.0, std::round(std::log2(plane->nearest_px / kSmallestGap_px)));
  const auto across = DeviationAcross(kSmallestGap_px * std::exp2(power));
  // A plane may fit a few points by chance: it is trusted no more than planes are elsewhere.
  const double sigma = across ? std::max(plane->deviation, *across) * plane->leverage_sigma : 0.0;
  if (!(sigma > 0.0) || !std::isfinite(sigma)) return std::nullopt;
  return DistancePrior{plane->log_distance, sigma};
}

}  // namespace pliant
