// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How far away the surface is between the points of the map: on the plane through the nearest of them, and as surely as
// they lie on it (docs/method.md, eq. G7).
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pliant/estimation/pose/moving_point.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/scene/map.h"

namespace pliant {

class SurfaceDistances {
 public:
  // Of the map's points as this camera sees them now; `neighbors`: points of a plane. Points whose own depth is from
  // the surface (Landmark::from_surface) say nothing new and are left out.
  SurfaceDistances(const Map& map, const Rigid3& cam_from_world, int neighbors);

  // Along a unit ray of the camera, at its pixel. Nothing where there are too few points, or where their plane is not
  // in front of the camera.
  std::optional<DistancePrior> At(const Eigen::Vector2d& pixel, const Eigen::Vector3d& ray) const;

 private:
  struct Plane {
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();      // n . x = 1
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of n, where the deviation is 1
    double deviation = 0;                                  // of its points, by their distance
  };
  std::optional<Plane> PlaneAt(const Eigen::Vector2d& pixel) const;

  std::size_t neighbors_;
  std::vector<Eigen::Vector2d> pixels_;
  std::vector<Eigen::Vector3d> points_in_cam_;
  double typical_deviation_ = 0;  // of planes at the points themselves, in the median
};

}  // namespace pliant
