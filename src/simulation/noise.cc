// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/noise.h"

#include <cmath>

namespace pliant::simulation {
namespace {

inline std::uint32_t LatticeHash(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t seed) {
  std::uint32_t h = seed ^ (static_cast<std::uint32_t>(x) * 0x8da6b343U) ^
                    (static_cast<std::uint32_t>(y) * 0xd8163841U) ^ (static_cast<std::uint32_t>(z) * 0xcb1ab31fU);
  h ^= h >> 15;
  h *= 0x2c1b3c6dU;
  h ^= h >> 12;
  h *= 0x297a2d39U;
  return h ^ (h >> 15);
}

// The product of the offset with one of the twelve directions to a cube's edges (four of them twice).
inline float CornerValue(std::uint32_t hash, float x, float y, float z) {
  const std::uint32_t h = hash & 15U;
  const float u = h < 8U ? x : y;
  const float v = h < 4U ? y : (h == 12U || h == 14U ? x : z);
  return ((h & 1U) != 0U ? -u : u) + ((h & 2U) != 0U ? -v : v);
}

inline float Fade(float t) { return t * t * t * (t * (t * 6.0F - 15.0F) + 10.0F); }
inline float Mix(float a, float b, float t) { return a + t * (b - a); }

}  // namespace

float GradientNoise(const Eigen::Vector3f& x, std::uint32_t seed) {
  const float fx = std::floor(x.x());
  const float fy = std::floor(x.y());
  const float fz = std::floor(x.z());
  const auto ix = static_cast<std::int32_t>(fx);
  const auto iy = static_cast<std::int32_t>(fy);
  const auto iz = static_cast<std::int32_t>(fz);
  const float dx = x.x() - fx;
  const float dy = x.y() - fy;
  const float dz = x.z() - fz;
  const auto corner = [&](int i, int j, int k) {
    return CornerValue(LatticeHash(ix + i, iy + j, iz + k, seed), dx - static_cast<float>(i),
                       dy - static_cast<float>(j), dz - static_cast<float>(k));
  };
  const float tx = Fade(dx);
  const float ty = Fade(dy);
  const float near = Mix(Mix(corner(0, 0, 0), corner(1, 0, 0), tx), Mix(corner(0, 1, 0), corner(1, 1, 0), tx), ty);
  const float far = Mix(Mix(corner(0, 0, 1), corner(1, 0, 1), tx), Mix(corner(0, 1, 1), corner(1, 1, 1), tx), ty);
  return Mix(near, far, Fade(dz));
}

}  // namespace pliant::simulation
