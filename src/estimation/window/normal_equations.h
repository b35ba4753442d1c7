// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What a trust region asks of the normal equations of a deforming window.
#pragma once

#include <Eigen/Core>

#include "estimation/window/deforming_terms.h"

namespace pliant {

class NormalEquations {
 public:
  virtual ~NormalEquations() = default;

  // Makes them those of `state`, in the memory of those before; false where they have no solution. All below is theirs.
  virtual bool Linearize(const DeformingState& state) = 0;

  // Of the cost as a function of what is solved for, all else following: gradient, and Gauss-Newton Hessian L L'.
  virtual const Eigen::VectorXd& gradient() const = 0;
  virtual Eigen::VectorXd HessianTimes(const Eigen::VectorXd& x) const = 0;
  virtual Eigen::VectorXd HessianDiagonal() const = 0;
  // By how much the linear model says that the cost falls by the eliminated unknowns alone.
  virtual double eliminated_decrease() const = 0;

  virtual Eigen::VectorXd NewtonStep() const = 0;
  // `step` without its part that changes the scale where that is free, in the metric of the diagonal `metric`.
  virtual Eigen::VectorXd WithoutScale(const Eigen::VectorXd& step, const Eigen::VectorXd& metric) const = 0;

  // The state after a step of what is solved for; the points stay.
  virtual DeformingState Moved(const DeformingState& state, const Eigen::VectorXd& step) const = 0;
};

// Keeps what nothing speaks of from making equations singular: a share of the diagonal, more where `factorize` fails.
// `factorize` takes the factor of the diagonal and is true where the equations could be solved with it.
template <typename Factorize>
bool WithRidge(const Factorize& factorize) {
  constexpr double kMinRidge = 1e-9;
  constexpr double kMaxRidge = 1.0;
  for (double ridge = kMinRidge; ridge < kMaxRidge; ridge *= 10.0)
    if (factorize(1.0 + ridge)) return true;
  return false;
}

}  // namespace pliant
