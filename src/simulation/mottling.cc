// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/mottling.h"

#include <algorithm>
#include <cmath>

#include "simulation/noise.h"

namespace pliant::simulation {

// Amplitudes are scaled so that the sum has a standard deviation of about one.
Mottling::Mottling(const SimulationOptions::Texture& options, Random random) {
  double amplitude = 1.0;
  double power = 0;
  for (double wave = options.largest_mm; wave >= 0.99 * options.smallest_mm; wave *= 0.5) {
    octaves_.push_back(
        {static_cast<float>(1.0 / wave), static_cast<float>(amplitude), static_cast<std::uint32_t>(random.Next())});
    power += amplitude * amplitude;
    amplitude *= options.persistence;
  }
  constexpr double kNoiseDeviation = 0.28;  // of GradientNoise
  for (Octave& octave : octaves_) octave.amplitude /= static_cast<float>(kNoiseDeviation * std::sqrt(power));
}

float Mottling::At(const Eigen::Vector3f& position) const {
  float sum = 0;
  for (const Octave& octave : octaves_)
    sum += octave.amplitude * GradientNoise(position * octave.inverse_wave, octave.seed);
  return sum;
}

float Mottling::At(const Eigen::Vector3f& position, float footprint_mm) const {
  float sum = 0;
  for (const Octave& octave : octaves_) {
    const float share = std::min(1.0F, 1.0F / (octave.inverse_wave * footprint_mm) - 1.0F);
    if (!(share > 0)) break;
    sum += share * octave.amplitude * GradientNoise(position * octave.inverse_wave, octave.seed);
  }
  return sum;
}

}  // namespace pliant::simulation
