// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The spatial term of one edge (docs/method.md, eq. E2): close points move alike.
//   r = (w_ij / sigma_spa) (delta_i - delta_j)        3 numbers, in standard deviations
// delta in mm (both in one frame, any: the norm does not depend on it), sigma_spa in mm, w_ij from the graph (eq. D2).
// Jacobian: dr / d delta_i = (w_ij / sigma_spa) I = -dr / d delta_j.
#pragma once

#include <Eigen/Core>

namespace pliant {

class SpatialKernel {
 public:
  SpatialKernel(double weight, double sigma_mm) : scale_(weight / sigma_mm) {}

  template <class T>
  Eigen::Matrix<T, 3, 1> Residual(const Eigen::Matrix<T, 3, 1>& delta_i, const Eigen::Matrix<T, 3, 1>& delta_j) const {
    return (delta_i - delta_j) * T(scale_);
  }
  // The Jacobian's only number: dr / d delta_i = scale * I.
  double scale() const { return scale_; }

 private:
  double scale_;
};

}  // namespace pliant
