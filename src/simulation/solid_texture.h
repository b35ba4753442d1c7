// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What is painted on a wall without a chart, as a function of the position at rest: mottling as on the chart's map
// (texture.h, with the same meaning of the value), and vessels that were grown on the surface in space.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "pliant/simulation/options.h"
#include "simulation/mottling.h"
#include "simulation/ray_scene.h"
#include "simulation/surface.h"

namespace pliant::simulation {

class SolidTexture {
 public:
  // `at_rest`: the surface's rays, not moved yet.
  SolidTexture(const SimulationOptions::Texture& options, int seed, const Surface& surface, const RayScene& at_rest);

  // The value at a position at rest, averaged over about `footprint_mm`.
  float At(const Eigen::Vector3f& position, float footprint_mm) const;

 private:
  struct Segment {
    Eigen::Vector3f from;
    Eigen::Vector3f to;
    float half_width_mm;
    float blood;
  };
  static std::uint64_t Cell(const Eigen::Vector3i& cell);
  void Grow(const SimulationOptions::Texture& options, Random random, const Surface& surface, const RayScene& at_rest);
  void Store(const Segment& segment);

  float contrast_;
  Mottling mottling_;
  std::vector<Segment> segments_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;  // looked up, never walked through
};

}  // namespace pliant::simulation
