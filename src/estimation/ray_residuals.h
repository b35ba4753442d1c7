// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Residuals on unit rays with their analytic derivatives, free of Ceres. Derivatives by a rotation are those of the
// polynomial R(q) x = x + 2 w (v x x) + 2 v x (v x x), q = (v, w) in Eigen's storage order x, y, z, w; on unit
// quaternions and along their tangents they are the derivatives of the rotation.
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pliant/geometry/rigid3.h"

namespace pliant {

using Matrix34d = Eigen::Matrix<double, 3, 4>;

// d (R(q) x) / d q.
inline Matrix34d RotationByQuaternion(const Eigen::Quaterniond& q, const Eigen::Vector3d& x) {
  const Eigen::Vector3d v = q.vec();
  Matrix34d d;
  d.leftCols<3>() = -2.0 * q.w() * Skew(x) + 2.0 * (v.dot(x) * Eigen::Matrix3d::Identity() + v * x.transpose()) -
                    4.0 * x * v.transpose();
  d.col(3) = 2.0 * v.cross(x);
  return d;
}

struct SampsonResidual {
  double value = 0;  // radians
  Eigen::RowVector4d by_rotation;
  Eigen::RowVector3d by_translation;
};

// r = c / s, c = f1 . (t x y), s^2 = |t x y|^2 + |t x f1|^2 - 2 c^2, y = R f0 (see geometry/essential.h). False where
// both rays point along t: nothing is measured there.
inline bool EvaluateSampson(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& t, const Eigen::Vector3d& ray0,
                            const Eigen::Vector3d& ray1, SampsonResidual* out) {
  const Eigen::Vector3d y = rotation * ray0;
  const Eigen::Vector3d t_cross_y = t.cross(y);
  const Eigen::Vector3d t_cross_f = t.cross(ray1);
  const double c = ray1.dot(t_cross_y);
  const double s_squared = t_cross_y.squaredNorm() + t_cross_f.squaredNorm() - 2.0 * c * c;
  if (!(s_squared > 0.0)) return false;
  const double s = std::sqrt(s_squared);
  out->value = c / s;

  // dr = dc / s - c / (2 s^3) d(s^2), with d(s^2) = d|t x y|^2 + d|t x f1|^2 - 4 c dc.
  const Eigen::Vector3d c_by_y = -t_cross_f;
  const Eigen::Vector3d c_by_t = y.cross(ray1);
  const Eigen::Vector3d s2_by_y = 2.0 * (t.squaredNorm() * y - t.dot(y) * t);
  const Eigen::Vector3d s2_by_t =
      2.0 * (y.squaredNorm() * t - t.dot(y) * y) + 2.0 * (ray1.squaredNorm() * t - t.dot(ray1) * ray1);
  const double by_c = 1.0 / s + 2.0 * c * c / (s_squared * s);
  const double by_s2 = -0.5 * c / (s_squared * s);
  out->by_rotation = (by_c * c_by_y + by_s2 * s2_by_y).transpose() * RotationByQuaternion(rotation, ray0);
  out->by_translation = (by_c * c_by_t + by_s2 * s2_by_t).transpose();
  return true;
}

// Two directions across a ray: an error's components, in which no camera model is needed.
using RayBasis = Eigen::Matrix<double, 2, 3>;
inline RayBasis BasisAcross(const Eigen::Vector3d& ray) {
  RayBasis basis;
  basis.row(0) = ray.unitOrthogonal().transpose();
  basis.row(1) = ray.cross(basis.row(0).transpose()).transpose();
  return basis;
}

struct DirectionResidual {
  Eigen::Vector2d value = Eigen::Vector2d::Zero();  // sine of the angle to the measured ray, by components
  Eigen::Matrix<double, 2, 4> by_rotation;
  Eigen::Matrix<double, 2, 3> by_translation;
  Eigen::Matrix<double, 2, 3> by_point;
};

// r = B p, p = x / |x|, x = R X + t: a point's direction across the measured ray. False for a point that does not lie
// in front of the measured ray, where the residual would pull the wrong way.
inline bool EvaluateDirection(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& t,
                              const Eigen::Vector3d& point, const Eigen::Vector3d& ray, const RayBasis& basis,
                              DirectionResidual* out) {
  const Eigen::Vector3d x = rotation * point + t;
  const double distance = x.norm();
  const Eigen::Vector3d p = x / distance;
  if (!(p.dot(ray) > 0.0)) return false;
  out->value = basis * p;
  const RayBasis by_x = (basis - out->value * p.transpose()) / distance;
  out->by_rotation = by_x * RotationByQuaternion(rotation, point);
  out->by_translation = by_x;
  out->by_point = by_x * rotation.toRotationMatrix();
  return true;
}

}  // namespace pliant
