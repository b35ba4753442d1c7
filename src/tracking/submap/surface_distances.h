// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How far away the surface is between the points of the map: on the plane through the nearest of them, and as surely as
// such planes tell the distances of the map's own points (docs/method.md, eq. G7).
#pragma once

#include <map>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pliant/estimation/pose/moving_point.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/scene/map.h"
#include "tracking/tracks/nearest_in_plane.h"

namespace pliant {

class SurfaceDistances {
 public:
  // Of the map's points as this camera sees them now; `neighbors`: points of a plane. Points whose own depth is from
  // the surface (Landmark::from_surface) say nothing new and are left out.
  SurfaceDistances(const Map& map, const Rigid3& cam_from_world, int neighbors);

  // Along a unit ray of the camera, at its pixel. Nothing where there are too few points, or too few with points as far
  // around them as there are here, or where the plane is not in front of the camera.
  std::optional<DistancePrior> At(const Eigen::Vector2d& pixel, const Eigen::Vector3d& ray);

 private:
  struct Plane {
    double log_distance = 0;    // infinite: it is not in front of the camera
    double leverage_sigma = 1;  // of log distance, where the points deviate by 1
    double deviation = 0;       // of its points, by their distance
    double nearest_px = 0;      // of its points, from the pixel
  };
  // Through the nearest points that are at least `gap_px` from the pixel.
  std::optional<Plane> PlaneAt(const Eigen::Vector2d& pixel, const Eigen::Vector3d& ray, double gap_px) const;
  // Nothing where too few points have such a plane.
  std::optional<double> DeviationAcross(double gap_px);

  std::size_t neighbors_;
  std::vector<Eigen::Vector2d> pixels_;
  std::vector<Eigen::Vector3d> points_in_cam_;
  std::optional<NearestInPlane> nearest_;               // of the pixels
  std::map<double, std::optional<double>> deviations_;  // across gaps that were asked for
};

}  // namespace pliant
