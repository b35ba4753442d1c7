// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "camera/roots.h"

#include <vector>

namespace pliant {
namespace {

double Evaluate(std::span<const double> coefficients, double x) {
  double value = 0;
  for (std::size_t i = coefficients.size(); i-- > 0;) value = value * x + coefficients[i];
  return value;
}

// The sign change between low and high, whose values have different signs, to the last bit.
double Bisect(std::span<const double> coefficients, double low, double high) {
  const bool positive_at_low = Evaluate(coefficients, low) > 0.0;
  while (true) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return low;
    ((Evaluate(coefficients, middle) > 0.0) == positive_at_low ? low : high) = middle;
  }
}

// All sign changes in (0, limit), ascending.
std::vector<double> Roots(std::span<const double> coefficients, double limit) {
  if (coefficients.size() < 2) return {};
  std::vector<double> derivative;
  for (std::size_t i = 1; i < coefficients.size(); ++i) derivative.push_back(static_cast<double>(i) * coefficients[i]);
  std::vector<double> knots = Roots(derivative, limit);
  knots.push_back(limit);
  std::vector<double> roots;
  double low = 0;
  for (const double high : knots) {
    if ((Evaluate(coefficients, low) > 0.0) != (Evaluate(coefficients, high) > 0.0))
      roots.push_back(Bisect(coefficients, low, high));
    low = high;
  }
  return roots;
}

}  // namespace

std::optional<double> FirstRoot(std::span<const double> coefficients, double limit) {
  const std::vector<double> roots = Roots(coefficients, limit);
  return roots.empty() ? std::nullopt : std::optional(roots.front());
}

}  // namespace pliant
