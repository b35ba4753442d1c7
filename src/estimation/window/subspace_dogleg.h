// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The subspace dogleg step of a trust region: the best step in the plane of Newton's step and of steepest descent
// (Byrd, Schnabel, Shultz, Mathematical Programming 1988).
#pragma once

#include <Eigen/Core>

#include "estimation/window/normal_equations.h"

namespace pliant {

class SubspaceDogleg {
 public:
  explicit SubspaceDogleg(const NormalEquations& equations);

  struct Step {
    Eigen::VectorXd step;
    double length = 0;
    double change = 0;  // of the model's cost; negative
  };
  // The model's minimum within `radius`; lengths are in the metric of the Hessian's diagonal.
  Step Best(double radius) const;

 private:
  double Change(const Eigen::Vector2d& x) const { return gradient_.dot(x) + 0.5 * x.dot(hessian_ * x); }

  Eigen::MatrixX2d axes_;  // orthonormal in the metric; the first is along Newton's step
  Eigen::Vector2d gradient_;
  Eigen::Matrix2d hessian_;
  double newton_length_ = 0;
};

}  // namespace pliant
