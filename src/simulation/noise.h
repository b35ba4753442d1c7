// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Smooth noise that is a function of position alone: the same position and seed give the same value on every thread.
#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace pliant::simulation {

// 64 well mixed bits of a counter (the finaliser of splitmix64).
inline std::uint64_t HashBits(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

// Gradient noise on the unit lattice: zero at every lattice point, mean 0, roughly within -1 and 1, standard deviation
// about 0.3. Source: Perlin, Improving Noise, SIGGRAPH 2002 (lattice, gradients and fade polynomial).
float GradientNoise(const Eigen::Vector3f& x, std::uint32_t seed);

// A value of about standard normal distribution from hash bits: the sum of four uniform ones.
inline float NormalFromBits(std::uint64_t bits) {
  constexpr float kMean = 2.0F * 65535.0F;
  constexpr float kInverseSigma = 1.0F / 37837.0F;  // sqrt(4 / 12) * 65536
  const float sum =
      static_cast<float>((bits & 0xffff) + ((bits >> 16) & 0xffff) + ((bits >> 32) & 0xffff) + (bits >> 48));
  return (sum - kMean) * kInverseSigma;
}

}  // namespace pliant::simulation
