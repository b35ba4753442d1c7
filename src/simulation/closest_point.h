// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Points, segments and triangles in space.
#pragma once

#include <array>

#include <Eigen/Core>

namespace pliant::simulation {

using Corners = std::array<Eigen::Vector3d, 3>;

// The point of a triangle that is nearest to `x`.
Eigen::Vector3d ClosestPoint(const Corners& triangle, const Eigen::Vector3d& x);

// Whether the straight way from one point to another goes through a triangle.
bool CrossesTriangle(const Corners& triangle, const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace pliant::simulation
