// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How the scene deforms: a displacement of every material point at every time, known in closed form, and its gradient.
// With V the point at rest in the world, the displacement is the sum of
//   the wave     d A sin(omega t + phase + k (V_x + V_y + V_z)),   k = 2 pi / wavelength, d = e_y
//                (Gomez Rodriguez, Montiel, Tardos, IROS 2022)
//   breathing    B sin(2 pi t / period + phase) (V - C) / R,       C(V): the position from which V swells
//   the poke     n P sin^2(pi t / period) exp(-|V - Q|^2 / (2 radius^2))
// In the second part of a scene (the upper lobe) A and B, d and the phases are its own.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pliant/simulation/options.h"

namespace pliant::simulation {

// A material point at rest with what its motion depends on.
struct RestPoint {
  Eigen::Vector3d position;
  Eigen::Vector3d swell_center = Eigen::Vector3d::Zero();  // C
  // dC/dV = swell_along swell_along': t / sqrt(1 - curvature . (V - C)) for the nearest point of a curve with tangent
  // t, zero for a fixed point.
  Eigen::Vector3d swell_along = Eigen::Vector3d::Zero();
  int part = 0;  // 0, or 1: the upper lobe
};

struct Poke {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();   // Q
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  // n
};

class Motion {
 public:
  Motion() = default;  // none
  // `swell_radius_mm`: R, the distance from C at which the wall moves by B.
  Motion(const SimulationOptions::Deformation& options, double swell_radius_mm, const Poke& poke);

  bool rigid() const;
  Eigen::Vector3d Position(const RestPoint& point, double time_s) const;
  // d Position / d V.
  Eigen::Matrix3d Gradient(const RestPoint& point, double time_s) const;
  // The direction of the surface's normal after the motion (inverse transpose of the gradient); unit length.
  Eigen::Vector3d Normal(const Eigen::Vector3d& normal_at_rest, const RestPoint& point, double time_s) const;
  // No point within `swell_reach_mm` of its C is ever farther from its position at rest than this.
  double LargestDisplacementMm(double swell_reach_mm) const;
  // No such point moves farther than this within so short a time.
  double LargestStepMm(double swell_reach_mm, double duration_s) const;

 private:
  struct Part {
    double wave_mm = 0;
    Eigen::Vector3d wave_direction = Eigen::Vector3d::UnitY();
    double swell_share = 0;
    double phase_rad = 0;
  };
  double SwellShare(const Part& part, double time_s) const;  // B sin(...) / R
  double PokeMm(const RestPoint& point, double time_s) const;

  std::array<Part, 2> parts_;
  double omega_rad_s_ = 0;
  double wavenumber_rad_mm_ = 0;
  double breathing_rad_s_ = 0;
  double poke_mm_ = 0;
  double poke_radius_mm_ = 1;
  double poke_rad_s_ = 0;
  Poke poke_;
};

// Where the deformation is no motion of a body any more, one sentence each: a wave that folds over (A k >= 1), another
// position and time (of those given) at which the gradient's determinant is not positive, lobes that run into each
// other.
std::vector<std::string> DeformationWarnings(const SimulationOptions& options, const Motion& motion,
                                             std::span<const RestPoint> points, std::span<const double> times_s);

}  // namespace pliant::simulation
