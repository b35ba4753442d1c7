// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The surface at rest: a triangle mesh, with a chart where it is a grid. Every scene ends as one of these.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pliant/base/status.h"
#include "pliant/simulation/options.h"
#include "pliant/simulation/simulator.h"
#include "simulation/centerline.h"
#include "simulation/motion.h"

namespace pliant::simulation {

// The vertices are rows of columns: vertex = row * columns + column. The chart is even on it: (0, 0) to its size, in
// mm.
struct SurfaceGrid {
  enum class Sides { kOpen, kClosed };
  int rows = 0;
  int columns = 0;
  Sides sides = Sides::kOpen;  // closed: the last column repeats the first one's position
  double chart_width_mm = 0;
  double chart_height_mm = 0;
};

// Positions are float because the rays' vertex buffer is: the mesh that is asked is exactly the mesh that is seen.
struct Surface {
  std::vector<Eigen::Vector3f> vertices;  // world, mm
  std::vector<Eigen::Vector3f> normals;   // unit, into the lumen
  std::vector<Eigen::Vector2f> chart;     // mm on a grid; 0 to 1 over `image`; else empty
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint8_t> part;             // of a vertex; empty: all are part 0. A triangle has one part.
  std::vector<Eigen::Vector3f> swell_center;  // of a vertex: what motion.h calls C
  std::vector<Eigen::Vector3f> swell_along;   // empty: zero
  double swell_radius_mm = 1;
  std::optional<SurfaceGrid> grid;
  cv::Mat image;       // CV_8UC3, what a mesh brought with it; else empty
  bool is_wet = true;  // has the film of Light.specular

  RestPoint VertexAtRest(std::uint32_t idx) const;
  RestPoint AtRest(const MaterialPoint& point) const;
  // Largest distance of a vertex from its C.
  double SwellReachMm() const;
};

// The triangles of a grid, and normals from differences of neighboring vertices: along x around. Triangles between two
// parts are left out. Needs vertices, grid and part.
void FillGrid(Surface& surface);

// Unevenness of a wall as a function of position: four octaves, standard deviation of about `relief_mm`.
double ReliefMm(const Eigen::Vector3d& position, double relief_mm, std::uint32_t seed);

// Scenes `colon` and `tube`: a bent tube of the given length around a centerline.
Surface MakeTube(const SimulationOptions::Scene& options, const Centerline& centerline, double length_mm);

// Scenes `surface` and `lobes`: a sheet below the way along z, which is at y = 0; it reaches from -height_mm to
// length_mm along the way.
Surface MakeSheet(const SimulationOptions::Scene& options, double height_mm, double length_mm);
// How far the upper lobe's underside lies above the lower lobe.
double LobeGapMm(const SimulationOptions::Scene& options);

// Scene `mesh`: read, scaled and divided until no edge is longer than mesh_step_mm. The sense of the normals is the
// file's. Fails as ReadMeshFile does and with kInvalidArgument for a size that no scene has.
Result<Surface> MakeMeshSurface(const SimulationOptions::Scene& options);

// Scene `board`: flat, with its picture (DrawBoard), seen from smaller z. Fails as ParseBoard and DrawBoard do.
Result<Surface> MakeBoardSurface(const SimulationOptions::Scene& options);

}  // namespace pliant::simulation
