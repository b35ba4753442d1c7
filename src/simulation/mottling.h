// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The mottling of a wall: octaves of noise at the position at rest, as a function of that position alone.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/random.h"
#include "pliant/simulation/options.h"

namespace pliant::simulation {

// How much blood a standard deviation of mottling stands for, and the middle of a wide vessel.
constexpr float kMottlingBlood = 0.36F;
constexpr float kVesselBlood = 1.0F;

class Mottling {
 public:
  Mottling(const SimulationOptions::Texture& options, Random random);

  // Mean 0, standard deviation about 1.
  float At(const Eigen::Vector3f& position) const;
  // The same without the waves that are shorter than what it is averaged over; waves up to twice that fade.
  float At(const Eigen::Vector3f& position, float footprint_mm) const;

 private:
  struct Octave {
    float inverse_wave;
    float amplitude;
    std::uint32_t seed;
  };
  std::vector<Octave> octaves_;  // longest first
};

}  // namespace pliant::simulation
