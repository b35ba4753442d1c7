// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Figures of triangle meshes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pliant/scene/mesh.h"

namespace pliant {

using Triangle = std::array<std::int32_t, 3>;

// Of unit length: the mean of the triangles' around a vertex, by their area; where these cancel each other, that of one
// of them (the z axis where it has no area); zero for a vertex of no triangle.
std::vector<Eigen::Vector3f> VertexNormals(std::span<const Eigen::Vector3f> vertices,
                                           std::span<const Triangle> triangles);

// The triangles whose vertices all have `keep` (one entry a vertex), and these vertices with all that is known of them.
Mesh PartOfMesh(const Mesh& mesh, const std::vector<bool>& keep);

// How a triangle is deformed in its plane.
struct TriangleStrain {
  float area_change = 0;      // area by the undeformed one, minus 1
  float largest_stretch = 1;  // principal stretches: length by the undeformed one
  float least_stretch = 1;
};

// One a triangle; none (the defaults) for a triangle without area.
std::vector<TriangleStrain> Strains(std::span<const Eigen::Vector3f> undeformed,
                                    std::span<const Eigen::Vector3f> deformed, std::span<const Triangle> triangles);

}  // namespace pliant
