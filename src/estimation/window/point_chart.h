// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A point by its chart: X = exp(d) (f + u b0 + v b1), f its ray in the reference and b0, b1 across it; parameters
// (u, v, d). Far points, whose depth is hardly known, make no trouble in d, and the gauge and the light are linear in
// it.
#pragma once

#include <cmath>

#include "estimation/ray_residuals.h"

namespace pliant {

struct PointChart {
  Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();
  RayBasis basis = RayBasis::Zero();

  static PointChart Across(const Eigen::Vector3d& ray) { return {ray, BasisAcross(ray)}; }

  Eigen::Vector3d Parameters(const Eigen::Vector3d& point) const {
    const double along = point.dot(ray);
    const Eigen::Vector2d across = basis * point / along;
    return {across.x(), across.y(), std::log(along)};
  }
  Eigen::Vector3d Point(const Eigen::Vector3d& parameters) const {
    return std::exp(parameters.z()) * (ray + basis.transpose() * parameters.head<2>());
  }
  // d X / d (u, v, d).
  Eigen::Matrix3d Derivative(const Eigen::Vector3d& parameters) const {
    Eigen::Matrix3d by;
    by.leftCols<2>() = std::exp(parameters.z()) * basis.transpose();
    by.col(2) = Point(parameters);
    return by;
  }
};

}  // namespace pliant
