// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Similarity of 3D space: a rigid motion and a change of the unit. `b_from_a` maps a point given in frame a and a's
// unit to the same point in frame b and b's unit.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pliant/geometry/rigid3.h"

namespace pliant {

// x_in_b = scale * (rotation * x_in_a) + translation; scale > 0.
struct Sim3 {
  double scale = 1.0;
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return scale * (rotation * x) + translation; }
  // Of a difference of two points.
  Eigen::Vector3d Turn(const Eigen::Vector3d& difference) const { return scale * (rotation * difference); }
  Sim3 Inverse() const {
    const Eigen::Quaterniond back = rotation.conjugate();
    return {1 / scale, back, -(back * translation) / scale};
  }
};

// c_from_a = c_from_b * b_from_a.
inline Sim3 operator*(const Sim3& c_from_b, const Sim3& b_from_a) {
  return {c_from_b.scale * b_from_a.scale, (c_from_b.rotation * b_from_a.rotation).normalized(),
          c_from_b * b_from_a.translation};
}

// A camera's pose, given in world a, in world b and b's unit.
inline Rigid3 PoseInWorld(const Sim3& b_from_a, const Rigid3& cam_from_a) {
  const Eigen::Quaterniond rotation = cam_from_a.rotation * b_from_a.rotation.conjugate();
  return {rotation, b_from_a.scale * cam_from_a.translation - rotation * b_from_a.translation};
}

// a_from_b of two worlds in which one camera has these poses; a length of 1 in b is `scale` in a.
inline Sim3 WorldFromPoses(const Rigid3& cam_from_a, const Rigid3& cam_from_b, double scale) {
  const Rigid3 a_from_cam = cam_from_a.Inverse();
  return {scale, (a_from_cam.rotation * cam_from_b.rotation).normalized(),
          a_from_cam * (scale * cam_from_b.translation)};
}

}  // namespace pliant
