// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Where the camera is at a time. A path relative to the centreline, chosen by name, and the tremor of the hand on top.
#pragma once

#include <array>

#include "pliant/geometry/rigid3.h"
#include "pliant/simulation/options.h"
#include "simulation/centreline.h"

namespace pliant::simulation {

// How far along the centreline the last camera stands.
double LastCameraMm(const SimulationOptions::Trajectory& options);

class Path {
 public:
  // `radius_mm` of the lumen: the swaying camera looks at its wall. Keeps a reference to the centreline.
  Path(const SimulationOptions::Trajectory& options, double radius_mm, int seed, const Centreline& centreline);

  Rigid3 WorldFromCamera(double time_s) const;

 private:
  struct Wave {
    double frequency_hz;
    double phase;
    double weight;
  };
  static constexpr int kWaves = 4;

  Rigid3 Follow(double s_mm) const;
  Rigid3 Sway(double time_s) const;
  Rigid3 Tremor(double time_s) const;  // steady camera from trembling camera

  SimulationOptions::Trajectory options_;
  double radius_mm_;
  const Centreline& centreline_;
  std::array<std::array<Wave, kWaves>, 6> tremor_;  // rotation about x, y, z, then translation
};

}  // namespace pliant::simulation
