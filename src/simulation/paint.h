// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What a wall looks like, whichever way the scene carries it: a map on the chart of a grid, or a solid texture, and for
// a mesh that brought one its own picture.
#pragma once

#include <optional>

#include "simulation/blood_map.h"
#include "simulation/image_texture.h"
#include "simulation/solid_texture.h"

namespace pliant::simulation {

// One of `map` and `solid` is there.
struct Paint {
  std::optional<BloodMap> map;
  std::optional<SolidTexture> solid;
  std::optional<ImageTexture> image;  // the albedo, instead of what the blood makes of it

  // `at_rest`: the surface's rays, not moved yet.
  Paint(const SimulationOptions::Texture& options, int seed, const Surface& surface, const RayScene& at_rest) {
    if (surface.grid) {
      map.emplace(options, seed, surface);
    } else {
      solid.emplace(options, seed, surface, at_rest);
    }
    if (!surface.image.empty()) image.emplace(surface);
  }

  // The amount of blood at a position, known by its chart or by where it is at rest.
  float Blood(const Eigen::Vector2f& chart, const Eigen::Vector3f& at_rest, float footprint_mm) const {
    return map ? map->At(chart.x(), chart.y(), footprint_mm) : solid->At(at_rest, footprint_mm);
  }
};

}  // namespace pliant::simulation
