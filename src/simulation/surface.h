// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The surface at rest: a triangle mesh with a chart. Every scene ends as one of these.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "pliant/simulation/options.h"
#include "simulation/centreline.h"

namespace pliant::simulation {

// Positions are float because the rays' vertex buffer is: the mesh that is asked is exactly the mesh that is seen.
struct Surface {
  std::vector<Eigen::Vector3f> vertices;  // world, mm
  std::vector<Eigen::Vector3f> normals;   // unit, into the lumen
  std::vector<Eigen::Vector2f> chart;     // mm: .x around (0 to chart_width_mm), .y along
  std::vector<std::array<std::uint32_t, 3>> triangles;
  double chart_width_mm = 0;  // the chart closes on itself in x
  double chart_height_mm = 0;
  // The vertices are a grid: vertex = row * columns + column; the last column repeats the first one's place.
  int rows = 0;
  int columns = 0;
};

// A bent tube of the given length around a centreline.
Surface MakeTube(const SimulationOptions::Scene& options, const Centreline& centreline, double length_mm);

}  // namespace pliant::simulation
