// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Rigid motion of 3D space. `b_from_a` maps a point given in frame a to the same point in frame b:
//   point_in_b = b_from_a * point_in_a,   c_from_a = c_from_b * b_from_a.
// Lengths are millimeters, or map units where a map has no scale. Quaternions are kept at unit length.
#pragma once

#include <cmath>
#include <numbers>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace pliant {

inline constexpr double kDegPerRad = 180.0 / std::numbers::pi;

struct Rigid3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Rigid3() = default;
  Rigid3(const Eigen::Quaterniond& r, const Eigen::Vector3d& t) : rotation(r.normalized()), translation(t) {}
  Rigid3(const Eigen::Matrix3d& r, const Eigen::Vector3d& t) : Rigid3(Eigen::Quaterniond(r), t) {}

  Eigen::Matrix3d RotationMatrix() const { return rotation.toRotationMatrix(); }
  // Where the origin of b lies in frame a (the camera's center in the world, for cam_from_world).
  Eigen::Vector3d OriginInSource() const { return rotation.conjugate() * -translation; }
  Rigid3 Inverse() const { return {rotation.conjugate(), rotation.conjugate() * -translation}; }
  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return rotation * x + translation; }
};

// c_from_a = c_from_b * b_from_a.
inline Rigid3 operator*(const Rigid3& c_from_b, const Rigid3& b_from_a) {
  return {c_from_b.rotation * b_from_a.rotation, c_from_b * b_from_a.translation};
}

// Between a (share 0) and b (share 1): the rotation turns evenly about one axis, the translation moves along a line.
inline Rigid3 Interpolated(const Rigid3& a, const Rigid3& b, double share) {
  return {a.rotation.slerp(share, b.rotation), (1.0 - share) * a.translation + share * b.translation};
}

// The rotation by |omega| radians about omega (exponential map of SO(3)); exact to rounding near zero.
inline Eigen::Quaterniond RotationExp(const Eigen::Vector3d& omega_rad) {
  const double angle = omega_rad.norm();
  const double half = 0.5 * angle;
  const double scale = angle < 1e-6 ? 0.5 - angle * angle / 48.0 : std::sin(half) / angle;
  Eigen::Quaterniond q;
  q.w() = std::cos(half);
  q.vec() = scale * omega_rad;
  return q.normalized();
}

// The angle of a rotation, radians in [0, pi].
inline double RotationAngle(const Eigen::Quaterniond& q) { return 2.0 * std::atan2(q.vec().norm(), std::abs(q.w())); }

// The skew-symmetric matrix with Skew(a) * b = a x b.
inline Eigen::Matrix3d Skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

}  // namespace pliant
