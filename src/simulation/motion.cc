// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/motion.h"

#include <cmath>
#include <numbers>

namespace pliant::simulation {

Motion::Motion(const SimulationOptions::Deformation& options)
    : amplitude_mm_(options.amplitude_mm),
      omega_rad_s_(options.omega_rad_s),
      wavenumber_rad_mm_(2.0 * std::numbers::pi / options.wavelength_mm) {}

Eigen::Vector3d Motion::Position(const Eigen::Vector3d& at_rest, double time_s) const {
  if (rigid()) return at_rest;
  Eigen::Vector3d moved = at_rest;
  moved.y() += amplitude_mm_ * std::sin(omega_rad_s_ * time_s + wavenumber_rad_mm_ * at_rest.sum());
  return moved;
}

Eigen::Vector3d Motion::Normal(const Eigen::Vector3d& normal_at_rest, const Eigen::Vector3d& at_rest,
                               double time_s) const {
  if (rigid()) return normal_at_rest;
  // Gradient F = I + a e_y (1,1,1), so F^-T n = n - a n_y / (1 + a) (1,1,1)  (Sherman and Morrison).
  const double a =
      amplitude_mm_ * wavenumber_rad_mm_ * std::cos(omega_rad_s_ * time_s + wavenumber_rad_mm_ * at_rest.sum());
  return (normal_at_rest - Eigen::Vector3d::Constant(a * normal_at_rest.y() / (1.0 + a))).normalized();
}

}  // namespace pliant::simulation
