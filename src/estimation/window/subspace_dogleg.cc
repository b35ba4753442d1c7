// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/window/subspace_dogleg.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace pliant {

SubspaceDogleg::SubspaceDogleg(const NormalEquations& equations) {
  constexpr double kMinMetric = 1e-6;
  constexpr double kParallel = 1e-12;
  const Eigen::VectorXd metric = equations.HessianDiagonal().cwiseMax(kMinMetric);
  const auto inner = [&](const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return a.cwiseProduct(metric).dot(b); };
  const Eigen::VectorXd newton = equations.NewtonStep();
  const Eigen::VectorXd downhill = equations.WithoutScale(-equations.gradient().cwiseQuotient(metric), metric);
  newton_length_ = std::sqrt(inner(newton, newton));
  axes_.setZero(newton.size(), 2);
  if (newton_length_ > 0.0) axes_.col(0) = newton / newton_length_;
  const Eigen::VectorXd across = downhill - inner(downhill, axes_.col(0)) * axes_.col(0);
  const double length = std::sqrt(inner(across, across));
  if (length > kParallel * std::sqrt(inner(downhill, downhill))) axes_.col(1) = across / length;
  gradient_ = axes_.transpose() * equations.gradient();
  for (int k = 0; k < 2; ++k) hessian_.col(k) = axes_.transpose() * equations.HessianTimes(axes_.col(k));
}

SubspaceDogleg::Step SubspaceDogleg::Best(double radius) const {
  constexpr int kDirections = 360;
  Eigen::Vector2d best(newton_length_, 0.0);
  if (newton_length_ > radius) {
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < kDirections; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / kDirections;
      const Eigen::Vector2d candidate = radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      if (Change(candidate) >= least) continue;
      least = Change(candidate);
      best = candidate;
    }
  }
  return {axes_ * best, best.norm(), Change(best)};
}

}  // namespace pliant
