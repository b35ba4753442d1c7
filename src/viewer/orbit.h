// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A viewpoint from which a whole scene is seen, in perspective.
#pragma once

#include <span>

#include <Eigen/Core>

#include "pliant/geometry/rigid3.h"

namespace pliant {

class Orbit {
 public:
  // From behind and above of a camera that looks so, and from where nearly all of `points` (not empty), and all of
  // `cameras`, are seen as large as a panel of this size allows. Panel pixels, from its top left
  // corner.
  Orbit(std::span<const Eigen::Vector3d> points, std::span<const Eigen::Vector3d> cameras,
        const Eigen::Quaterniond& world_from_cam, double azimuth_deg, double elevation_deg, double width_px,
        double height_px);

  // x, y in the panel and the distance along the view; behind the eye the distance is not positive.
  Eigen::Vector3d Project(const Eigen::Vector3d& point) const;

  // From where the scene is seen, in its world.
  Eigen::Vector3d Eye() const { return eye_from_world_.OriginInSource(); }

 private:
  Rigid3 eye_from_world_;
  double focal_px_ = 1;
  double width_px_;
  double height_px_;
};

}  // namespace pliant
