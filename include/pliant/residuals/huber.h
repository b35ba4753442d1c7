// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Huber's robust loss on a squared norm (docs/method.md, eq. E4), in Ceres' convention: HuberLoss(sqrt(chi2)).
//   rho(s) = s                          for s <= chi2
//          = 2 sqrt(chi2 s) - chi2      beyond,
// s = |r|^2 of a residual in units of its standard deviation, chi2 a quantile of its chi-square distribution.
// The cost is 0.5 * rho; the pull of an outlier on the solution is bounded by sqrt(chi2) * |dr/dx|.
#pragma once

#include <cmath>

namespace pliant {

struct RobustCost {
  double rho = 0;
  double derivative = 1;  // d rho / d s, in (0, 1]
};

inline RobustCost Huber(double squared_norm, double chi2) {
  if (squared_norm <= chi2) return {squared_norm, 1.0};
  const double root = std::sqrt(chi2 * squared_norm);
  return {2.0 * root - chi2, chi2 / root};
}

}  // namespace pliant
