// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/window/planar_ambiguity.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "estimation/window/window_samples.h"
#include "pliant/base/statistics.h"
#include "pliant/estimation/two_view/two_view_models.h"
#include "pliant/geometry/decompositions.h"
#include "pliant/geometry/triangulation.h"

namespace pliant {
namespace {

// m with m . X = 1 for the plane nearest to the points, reweighted by their distances to it (Cauchy).
Eigen::Vector3d NearestPlane(const std::vector<Eigen::Vector3d>& points) {
  constexpr int kRounds = 10;
  constexpr double kScale = 0.05;
  Eigen::Vector3d plane = Eigen::Vector3d::Zero();
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& point : points) {
      const double error = round == 0 ? 0.0 : (plane.dot(point) - 1.0) / kScale;
      const double weight = 1.0 / (1.0 + error * error);
      squares += weight * point * point.transpose();
      sum += weight * point;
    }
    plane = squares.ldlt().solve(sum);
  }
  return plane;
}

}  // namespace

bool NearlyFlat(const std::vector<Eigen::Vector3d>& points_in_world) {
  constexpr double kFlat = 0.1;  // median distance from the plane along the ray, by the plane's distance there
  const Eigen::Vector3d plane = NearestPlane(points_in_world);
  std::vector<double> distances;
  for (const Eigen::Vector3d& point : points_in_world) distances.push_back(std::abs(plane.dot(point) - 1.0));
  return Median(std::move(distances)) < kFlat;
}

std::optional<DeformingWindow> OtherPlanarMotion(const DeformingWindow& solved, double focal_px,
                                                 const DeformingWindowOptions& options) {
  // Of a ray and the plane's normal; points further out stay at this one's distance.
  constexpr double kMinCosine = 0.1;
  const Rigid3& last = solved.cams_from_world.back();
  if (last.translation.norm() == 0.0) return std::nullopt;
  const Eigen::Matrix3d any_scale =
      last.rotation.toRotationMatrix() + last.translation * NearestPlane(solved.points_in_world).transpose();
  const Eigen::Matrix3d homography = any_scale / SvdOf(any_scale).singular_values[1];
  const std::vector<Rigid3> motions = MotionsFromHomography(homography, DirectionsOf(solved.points_in_world));
  if (motions.size() < 2) return std::nullopt;
  const auto difference = [&](const Rigid3& motion) {
    return RotationAngle(motion.rotation * last.rotation.conjugate()) +
           AngleBetween(motion.translation, last.translation);
  };
  const Rigid3& other = difference(motions[0]) > difference(motions[1]) ? motions[0] : motions[1];
  // H = R + t m', |t| = 1, and the plane is m . X = 1.
  const Eigen::Vector3d plane = (homography - other.rotation.toRotationMatrix()).transpose() * other.translation;
  if (!(plane.norm() > 0.0)) return std::nullopt;

  DeformingWindow start = solved;
  for (Eigen::Vector3d& point : start.points_in_world) {
    const Eigen::Vector3d direction = point.normalized();
    point = direction / std::max(plane.dot(direction), kMinCosine * plane.norm());
  }
  const double scale = solved.MedianDistance() / start.MedianDistance();
  for (Eigen::Vector3d& point : start.points_in_world) point *= scale;
  auto optimized = OptimizeDeformingViews(start, focal_px, options);
  if (!optimized.ok()) return std::nullopt;
  return std::move(*optimized);
}

}  // namespace pliant
