// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The light that comes back along a ray. One small light sits in the camera (the left one of a pair):
//   L = (50 mm / d)^2 ( albedo ((1 - a) cos + a) + s exp(-tan^2 / m^2) )
// cos of the angle between light and normal, d the distance of the light, a the ambient share, s and m the wet
// reflection's peak and facet slope (Beckmann's distribution), tan of the angle between the normal and the direction
// halfway between light and view; for it the normal is tilted by the slope of the mottling. Albedo
// falls with the local amount of blood, least in the red.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "pliant/simulation/options.h"
#include "simulation/paint.h"
#include "simulation/ray_scene.h"
#include "simulation/surface.h"

namespace pliant::simulation {

class Shader {
 public:
  // `pixel_rad`: the angle that a sample covers. Keeps references to the surface and the paint.
  Shader(const SimulationOptions::Light& options, const Surface& surface, const Paint& paint, double pixel_rad);

  // Blue, green, red; 1 is about a white wall at 50 mm. `direction` of the ray, unit; `light_from_eye`: the light's
  // position by the ray's origin, in the world; `normals`: the vertices' unit normals as posed.
  Eigen::Vector3f Radiance(const RayHit& hit, const Eigen::Vector3d& direction, const Eigen::Vector3d& light_from_eye,
                           const std::vector<Eigen::Vector3f>& normals) const;

 private:
  // Where a ray met the surface at rest, by the chart and in space; what the surface has none of is zero.
  struct SurfacePosition {
    Eigen::Vector2f chart = Eigen::Vector2f::Zero();
    Eigen::Vector3f at_rest = Eigen::Vector3f::Zero();
  };
  SurfacePosition PositionOf(const std::array<std::uint32_t, 3>& triangle, float b1, float b2) const;
  const Eigen::Vector3f& AlbedoOf(float blood) const;
  // The normal of the wet film on a patch of this size.
  Eigen::Vector3f Facet(const std::array<std::uint32_t, 3>& triangle, const SurfacePosition& position,
                        const Eigen::Vector3f& normal, float size_mm) const;

  static constexpr int kAlbedoSteps = 2048;

  SimulationOptions::Light options_;
  const Surface& surface_;
  const Paint& paint_;
  float pixel_rad_;
  std::array<Eigen::Vector3f, kAlbedoSteps> albedo_;  // over blood from kMinBlood to kMaxBlood
};

}  // namespace pliant::simulation
