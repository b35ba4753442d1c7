// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/closest_point.h"

#include <algorithm>

#include <Eigen/Geometry>

namespace pliant::simulation {
namespace {

Eigen::Vector3d ClosestOnEdge(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& x) {
  const Eigen::Vector3d ab = b - a;
  const double length_sq = ab.squaredNorm();
  if (length_sq == 0) return a;
  return a + std::clamp((x - a).dot(ab) / length_sq, 0.0, 1.0) * ab;
}

}  // namespace

Eigen::Vector3d ClosestPoint(const Corners& triangle, const Eigen::Vector3d& x) {
  const auto& [a, b, c] = triangle;
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  // Above the inside of the triangle its plane is nearest, else one of its edges.
  const bool above = normal.cross(b - a).dot(x - a) >= 0 && normal.cross(c - b).dot(x - b) >= 0 &&
                     normal.cross(a - c).dot(x - c) >= 0 && normal.squaredNorm() > 0;
  if (above) return x - (x - a).dot(normal) / normal.squaredNorm() * normal;
  Eigen::Vector3d nearest = ClosestOnEdge(a, b, x);
  for (const Eigen::Vector3d& other : {ClosestOnEdge(b, c, x), ClosestOnEdge(c, a, x)})
    if ((other - x).squaredNorm() < (nearest - x).squaredNorm()) nearest = other;
  return nearest;
}

bool CrossesTriangle(const Corners& triangle, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const auto& [a, b, c] = triangle;
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double from_side = (from - a).dot(normal);
  const double to_side = (to - a).dot(normal);
  if ((from_side > 0) == (to_side > 0)) return false;
  const Eigen::Vector3d x = from + from_side / (from_side - to_side) * (to - from);
  return normal.cross(b - a).dot(x - a) >= 0 && normal.cross(c - b).dot(x - b) >= 0 &&
         normal.cross(a - c).dot(x - c) >= 0;
}

}  // namespace pliant::simulation
