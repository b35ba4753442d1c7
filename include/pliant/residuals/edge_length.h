// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The edge-length term of one edge, local isometry (docs/method.md, eq. E8): a surface bends but hardly stretches.
//   r = (|p_i - p_j| - rest_ij) / sigma_len        1 number, in standard deviations
// p = X + delta, the present positions (any one frame), rest_ij and sigma_len in mm.
// Jacobian: dr / dp_i = u^T / sigma_len = -dr / dp_j with u = (p_i - p_j) / |p_i - p_j|. Where the points coincide the
// direction is undetermined; the Jacobian is then zero, which is the mean of what the directions would give.
#pragma once

#include <Eigen/Core>

namespace pliant {

class EdgeLengthKernel {
 public:
  EdgeLengthKernel(double rest_length_mm, double sigma_mm) : rest_length_(rest_length_mm), scale_(1.0 / sigma_mm) {}

  template <class T>
  T Residual(const Eigen::Matrix<T, 3, 1>& position_i, const Eigen::Matrix<T, 3, 1>& position_j) const {
    return ((position_i - position_j).norm() - T(rest_length_)) * T(scale_);
  }

  // dr / dp_i as a column; dr / dp_j is its negative.
  Eigen::Vector3d Jacobian(const Eigen::Vector3d& position_i, const Eigen::Vector3d& position_j) const {
    const Eigen::Vector3d difference = position_i - position_j;
    const double length = difference.norm();
    if (!(length > 0.0)) return Eigen::Vector3d::Zero();
    return difference * (scale_ / length);
  }

 private:
  double rest_length_;
  double scale_;
};

}  // namespace pliant
