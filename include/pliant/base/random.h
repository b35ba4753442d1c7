// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Random numbers that repeat: the same seed gives the same numbers with every compiler and library, and a child is
// derived by name, so that adding a consumer never changes what another one draws. There is no global state.
// Generator: splitmix64 (Steele, Lea, Flood, OOPSLA 2014).
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>

namespace pliant {

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  // An independent generator for the consumer called `name` (FNV-1a of the name, mixed with this one's state).
  Random Child(std::string_view name) const {
    std::uint64_t hash = 0xcbf29ce484222325ULL;
    for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
    Random child(state_ ^ hash);
    return Random(child.Next());
  }

  // 64 uniform bits.
  std::uint64_t Next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }
  // Uniform in [0, 1).
  double Uniform() { return static_cast<double>(Next() >> 11) * 0x1.0p-53; }
  // Uniform in [low, high).
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }
  // Uniform in {0, ..., count - 1}; count > 0.
  int Index(int count) { return static_cast<int>(Uniform() * count); }
  // Normal with mean 0 and standard deviation `sigma` (Box-Muller, one value a call).
  double Normal(double sigma = 1.0) {
    const double u = 1.0 - Uniform();
    return sigma * std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * Uniform());
  }

 private:
  std::uint64_t state_;
};

}  // namespace pliant
