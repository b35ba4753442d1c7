// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The temporal term of one point (docs/method.md, eq. E3): a point moves little from one frame to the next.
//   r = delta_i / sigma_tmp        3 numbers, in standard deviations
// delta and sigma_tmp in mm. Jacobian: dr / d delta_i = I / sigma_tmp.
#pragma once

#include <Eigen/Core>

namespace pliant {

class TemporalKernel {
 public:
  explicit TemporalKernel(double sigma_mm) : scale_(1.0 / sigma_mm) {}

  template <class T>
  Eigen::Matrix<T, 3, 1> Residual(const Eigen::Matrix<T, 3, 1>& delta) const {
    return delta * T(scale_);
  }
  // The Jacobian's only number: dr / d delta = scale * I.
  double scale() const { return scale_; }

 private:
  double scale_;
};

}  // namespace pliant
