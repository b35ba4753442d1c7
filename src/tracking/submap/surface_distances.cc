// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/submap/surface_distances.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

constexpr std::size_t kMinNeighbors = 6;  // twice the unknowns of a plane
constexpr double kMinDeviation = 1e-3;    // tissue is not flatter than that

}  // namespace

SurfaceDistances::SurfaceDistances(const Map& map, const Rigid3& cam_from_world, int neighbors)
    : neighbors_(static_cast<std::size_t>(std::max(neighbors, 0))) {
  for (const Landmark& landmark : map.landmarks) {
    if (landmark.from_surface) continue;
    pixels_.push_back(landmark.pixel);
    points_in_cam_.push_back(cam_from_world * landmark.position);
  }
  std::vector<double> deviations;
  for (const Eigen::Vector2d& pixel : pixels_)
    if (const auto plane = PlaneAt(pixel)) deviations.push_back(plane->deviation);
  if (!deviations.empty()) typical_deviation_ = Median(std::move(deviations));
}

// By linear least squares of n . x = 1, whose residuals are relative distances from the plane.
std::optional<SurfaceDistances::Plane> SurfaceDistances::PlaneAt(const Eigen::Vector2d& pixel) const {
  std::vector<std::pair<double, std::size_t>> nearest;
  for (std::size_t i = 0; i < pixels_.size(); ++i) nearest.emplace_back((pixels_[i] - pixel).squaredNorm(), i);
  const std::size_t count = std::min(nearest.size(), neighbors_);
  if (count < kMinNeighbors) return std::nullopt;
  std::partial_sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(count), nearest.end());
  Eigen::MatrixX3d points(static_cast<Eigen::Index>(count), 3);
  for (std::size_t k = 0; k < count; ++k)
    points.row(static_cast<Eigen::Index>(k)) = points_in_cam_[nearest[k].second].transpose();
  const Eigen::LDLT<Eigen::Matrix3d> factor(points.transpose() * points);
  if (factor.info() != Eigen::Success || !factor.isPositive()) return std::nullopt;
  Plane plane;
  plane.normal = factor.solve(points.colwise().sum().transpose());
  plane.covariance = factor.solve(Eigen::Matrix3d::Identity());
  const double squares = ((points * plane.normal).array() - 1.0).square().sum();
  plane.deviation = std::max(kMinDeviation, std::sqrt(squares / static_cast<double>(count - 3)));
  if (!plane.normal.allFinite() || !plane.covariance.allFinite()) return std::nullopt;
  return plane;
}

std::optional<DistancePrior> SurfaceDistances::At(const Eigen::Vector2d& pixel, const Eigen::Vector3d& ray) const {
  const auto plane = PlaneAt(pixel);
  if (!plane) return std::nullopt;
  const double inverse_distance = plane->normal.dot(ray);
  if (!(inverse_distance > 0.0)) return std::nullopt;
  // A plane may fit a few points by chance: it is trusted no more than planes are elsewhere.
  const Eigen::Vector3d x = ray / inverse_distance;
  const double deviation = std::max(plane->deviation, typical_deviation_);
  const double sigma = deviation * std::sqrt(1.0 + x.dot(plane->covariance * x));
  if (!(sigma > 0.0) || !std::isfinite(sigma)) return std::nullopt;
  return DistancePrior{-std::log(inverse_distance), sigma};
}

}  // namespace pliant
