// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The camera's pose as six numbers around a reference pose (docs/method.md, eq. E9):
//   x_in_cam = Exp(omega) R0 (X - pivot) + (R0 pivot + t0) + tau
// increment = (omega rad, tau mm); zero is the reference. Rotating about a pivot amid the points keeps rotation and
// translation apart, which makes the problem better conditioned. Exp is the rotation by |omega| about omega; the
// increment covers rotations below a full turn.
// Jacobian: d x_in_cam / d tau = I,  d x_in_cam / d omega = -[Exp(omega) R0 (X - pivot)]x Jl(omega),
//   Jl(omega) = I + (1 - cos a)/a^2 [omega]x + (a - sin a)/a^3 [omega]x^2,  a = |omega|   (SO(3)'s left Jacobian).
#pragma once

#include <cmath>

#include <Eigen/Core>

#include "pliant/geometry/rigid3.h"

namespace pliant {

using Vector6d = Eigen::Matrix<double, 6, 1>;

// Exp(omega) x, by Rodrigues' formula; T: double or a type of automatic derivatives.
template <class T>
Eigen::Matrix<T, 3, 1> RotateByExp(const Eigen::Matrix<T, 3, 1>& omega_rad, const Eigen::Matrix<T, 3, 1>& x) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  const T squared = omega_rad.squaredNorm();
  T a = T(1.0) - squared / 6.0;   // sin(angle) / angle
  T b = T(0.5) - squared / 24.0;  // (1 - cos(angle)) / angle^2
  if (squared > 1e-8) {           // below, the next terms of the series are under rounding
    const T angle = sqrt(squared);
    const T half_sine = sin(0.5 * angle);
    a = sin(angle) / angle;
    b = 2.0 * half_sine * half_sine / squared;
  }
  const Eigen::Matrix<T, 3, 1> cross = omega_rad.cross(x);
  return x + a * cross + b * omega_rad.cross(cross);
}

// SO(3)'s left Jacobian: Exp(omega + d) = Exp(Jl(omega) d) Exp(omega) to first order in d.
inline Eigen::Matrix3d LeftJacobian(const Eigen::Vector3d& omega_rad) {
  const double squared = omega_rad.squaredNorm();
  double b = 0.5 - squared / 24.0;
  double c = 1.0 / 6.0 - squared * (1.0 / 120.0 - squared * (1.0 / 5040.0 - squared / 362880.0));
  if (squared > 1e-8) {
    const double half_sine = std::sin(0.5 * std::sqrt(squared));
    b = 2.0 * half_sine * half_sine / squared;
  }
  if (squared > 1e-2) {
    const double angle = std::sqrt(squared);
    c = (angle - std::sin(angle)) / (squared * angle);
  }
  const Eigen::Matrix3d skew = Skew(omega_rad);
  return Eigen::Matrix3d::Identity() + b * skew + c * skew * skew;
}

// A point of the world in the camera frame, and its derivatives by the increment (eq. E9).
struct PosedPoint {
  Eigen::Vector3d omega_rad;  // of the increment
  Eigen::Vector3d arm;        // Exp(omega) R0 (X - pivot)
  Eigen::Vector3d in_cam;

  Eigen::Matrix<double, 3, 6> ByIncrement() const {
    Eigen::Matrix<double, 3, 6> by_increment;
    by_increment.leftCols<3>() = -Skew(arm) * LeftJacobian(omega_rad);
    by_increment.rightCols<3>().setIdentity();
    return by_increment;
  }
};

class PoseIncrement {
 public:
  PoseIncrement() = default;
  PoseIncrement(const Rigid3& reference_cam_from_world, const Eigen::Vector3d& pivot_in_world)
      : rotation_(reference_cam_from_world.RotationMatrix()),
        pivot_(pivot_in_world),
        pivot_in_cam_(reference_cam_from_world * pivot_in_world) {}

  // R0 (X - pivot): constant while the increment is sought.
  Eigen::Vector3d Arm(const Eigen::Vector3d& point_in_world) const { return rotation_ * (point_in_world - pivot_); }
  const Eigen::Matrix3d& reference_rotation() const { return rotation_; }
  const Eigen::Vector3d& pivot_in_cam() const { return pivot_in_cam_; }

  template <class T>
  Eigen::Matrix<T, 3, 1> Transform(const Eigen::Matrix<T, 6, 1>& increment,
                                   const Eigen::Matrix<T, 3, 1>& point_in_world) const {
    const Eigen::Matrix<T, 3, 1> centered = point_in_world - pivot_.cast<T>();
    const Eigen::Matrix<T, 3, 1> arm = rotation_.cast<T>() * centered;
    const Eigen::Matrix<T, 3, 1> omega = increment.template head<3>();
    return RotateByExp(omega, arm) + pivot_in_cam_.cast<T>() + increment.template tail<3>();
  }

  // The point at `increment`, which are 6 numbers.
  PosedPoint Posed(const double* increment, const Eigen::Vector3d& point_in_world) const {
    const Eigen::Vector3d omega = Eigen::Map<const Eigen::Vector3d>(increment);
    const Eigen::Vector3d arm = RotateByExp<double>(omega, Arm(point_in_world));
    return {omega, arm, arm + pivot_in_cam_ + Eigen::Map<const Eigen::Vector3d>(increment + 3)};
  }

  // cam_from_world at an increment.
  Rigid3 Pose(const Vector6d& increment) const {
    const Eigen::Quaterniond rotation = RotationExp(increment.head<3>()) * Eigen::Quaterniond(rotation_);
    return {rotation, pivot_in_cam_ + increment.tail<3>() - rotation * pivot_};
  }

 private:
  Eigen::Matrix3d rotation_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d pivot_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d pivot_in_cam_ = Eigen::Vector3d::Zero();
};

}  // namespace pliant
