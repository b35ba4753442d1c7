// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The map: material points and where they are now. Plain values; only the tracker changes them. World frame: the
// camera frame of the reference image. Units are map units: millimeters after a metric start, else scaled once so that
// the median depth of the first map is the configured nominal depth.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/ids.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/geometry/sim3.h"

namespace pliant {

// Lengths in the files of a run have six decimals: below it less than three digits are left.
inline constexpr double kMinHeldDistance_mm = 1e-3;

struct Landmark {
  PointId id;
  Eigen::Vector3d rest_position = Eigen::Vector3d::Zero();  // when it entered the map: undeformed
  Eigen::Vector3d position = Eigen::Vector3d::Zero();       // X_i^{t-1}: in the last tracked frame
  Eigen::Vector3d last_motion = Eigen::Vector3d::Zero();    // delta_i of the last tracked frame
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();          // where it was last measured
  std::optional<Eigen::Vector2d> sharp_pixel = {};  // in the last sharp image, while `pixel` is of a blurred one
  double ssim = 1;                                  // of that measurement, to its reference patch
  double log_distance_sigma = 0;  // of its distance from the camera when that was determined; 0: not known
  Eigen::Vector3d determined_at = Eigen::Vector3d::Zero();  // its position then
  int times_reestimated = 0;                                // the re-estimated maps that had it
  bool from_surface = false;                                // its depth, when it entered: by the points around it (G7)
  bool measured = false;                                    // its depth, at the start: by a pair or a depth image
};

// (E13) Standard deviation of its distance from the camera, map units; 0: not known. What it has moved by since its
// distance was determined is uncertain by as much: along its ray the regularizers alone say it.
double DistanceSigma(const Landmark& landmark, const Rigid3& cam_from_world);

// A landmark in another world.
Landmark Moved(const Sim3& other_from_world, const Landmark& landmark);

// Landmarks that are alive, sorted by id.
struct Map {
  std::vector<Landmark> landmarks;

  // The landmark with this id, or null.
  Landmark* Find(PointId id);
  const Landmark* Find(PointId id) const;
};

}  // namespace pliant
