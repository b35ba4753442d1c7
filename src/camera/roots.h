// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Roots of one variable, found with certainty rather than speed where they bound a domain (FirstRoot) and quickly where
// a pixel is undistorted (InvertGrowing).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

namespace pliant {

// The smallest x in (0, limit) at which c[0] + c[1] x + c[2] x^2 + ... reaches zero, for a polynomial that is positive
// at 0; nothing if it stays positive. Every root lies between two neighboring roots of the derivative, which are found
// the same way.
std::optional<double> FirstRoot(std::span<const double> coefficients, double limit);

// The x in [0, limit) with function(x) = target, for a function that grows on that interval from 0 at 0; exact to
// rounding. `double function(double x, double* derivative)`. Newton's method inside a bracket that only shrinks,
// bisecting when a step leaves it or gains too little. Nothing if target is not in [0, function(limit)).
template <class Function>
std::optional<double> InvertGrowing(const Function& function, double target, double limit) {
  double derivative = 0;
  if (!(target >= 0.0 && target < function(limit, &derivative))) return std::nullopt;
  double low = 0;
  double high = limit;
  double x = std::min(target, 0.5 * limit);
  double last_error = std::numeric_limits<double>::infinity();
  for (int step = 0; step < 400; ++step) {
    const double error = function(x, &derivative) - target;
    if (error == 0.0) return x;
    (error > 0.0 ? high : low) = x;
    double next = x - error / derivative;
    const bool gains = std::abs(error) < 0.5 * last_error;
    // The last steps are of rounding's size and need not gain.
    if (std::abs(next - x) <= 2.0 * std::numeric_limits<double>::epsilon() * x) return x;
    if (!(next > low && next < high) || !gains) next = 0.5 * (low + high);
    if (next == low || next == high) return x;
    last_error = std::abs(error);
    x = next;
  }
  return std::nullopt;
}

}  // namespace pliant
