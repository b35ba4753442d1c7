// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How the scene deforms: a displacement of every material point at every time, known in closed form.
//   V_y(t) = V_y + A sin(omega t + k (V_x + V_y + V_z)),  V the point at rest in the world, k = 2 pi / wavelength
// (Gomez Rodriguez, Montiel, Tardos, IROS 2022).
#pragma once

#include <Eigen/Core>

#include "pliant/simulation/options.h"

namespace pliant::simulation {

class Motion {
 public:
  explicit Motion(const SimulationOptions::Deformation& options);

  bool rigid() const { return amplitude_mm_ == 0.0; }
  Eigen::Vector3d Position(const Eigen::Vector3d& at_rest, double time_s) const;
  // The direction of the surface's normal after the motion (inverse transpose of its gradient); unit length.
  Eigen::Vector3d Normal(const Eigen::Vector3d& normal_at_rest, const Eigen::Vector3d& at_rest, double time_s) const;

 private:
  double amplitude_mm_;
  double omega_rad_s_;
  double wavenumber_rad_mm_;
};

}  // namespace pliant::simulation
