// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/surface.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <tbb/parallel_for.h>

#include "simulation/noise.h"

namespace pliant::simulation {
namespace {

void FillNormals(Surface& surface) {
  const auto& [rows, columns, sides, width_mm, height_mm] = *surface.grid;
  const bool closed = sides == SurfaceGrid::Sides::kClosed;
  const int last_row = rows - 1;
  const int last = columns - 1;
  const auto at = [&surface, columns = columns](int row, int column) {
    return surface.vertices[static_cast<std::size_t>(row) * columns + column];
  };
  surface.normals.resize(surface.vertices.size());
  tbb::parallel_for(0, rows, [&, columns = columns](int row) {
    const int above = std::max(row - 1, 0);
    const int below = std::min(row + 1, last_row);
    for (int column = 0; column <= last; ++column) {
      const int left = column > 0 ? column - 1 : (closed ? last - 1 : 0);
      const int right = column < last ? column + 1 : (closed ? 1 : last);
      const Eigen::Vector3f along = at(below, column) - at(above, column);
      const Eigen::Vector3f around = at(row, right) - at(row, left);
      surface.normals[static_cast<std::size_t>(row) * columns + column] = along.cross(around).normalized();
    }
  });
}

void FillTriangles(Surface& surface) {
  const int rows = surface.grid->rows;
  const int columns = surface.grid->columns;
  const auto part = [&](std::uint32_t idx) { return surface.part.empty() ? 0 : surface.part[idx]; };
  surface.triangles.reserve(static_cast<std::size_t>(rows - 1) * (columns - 1) * 2);
  for (int row = 0; row + 1 < rows; ++row) {
    for (int column = 0; column + 1 < columns; ++column) {
      const auto a = static_cast<std::uint32_t>(row * columns + column);
      const auto b = a + 1;
      const auto c = a + static_cast<std::uint32_t>(columns);
      const auto d = c + 1;
      if (part(a) != part(b) || part(c) != part(d)) continue;
      surface.triangles.push_back({a, b, c});
      surface.triangles.push_back({b, d, c});
    }
  }
}

}  // namespace

RestPoint Surface::VertexAtRest(std::uint32_t idx) const {
  RestPoint point;
  point.position = vertices[idx].cast<double>();
  point.swell_center = swell_center[idx].cast<double>();
  if (!swell_along.empty()) point.swell_along = swell_along[idx].cast<double>();
  point.part = part.empty() ? 0 : part[idx];
  return point;
}

RestPoint Surface::AtRest(const MaterialPoint& point) const {
  const auto& t = triangles[point.triangle_idx];
  const auto mix = [&](const std::vector<Eigen::Vector3f>& v) -> Eigen::Vector3d {
    return (1.0 - point.b1 - point.b2) * v[t[0]].cast<double>() + point.b1 * v[t[1]].cast<double>() +
           point.b2 * v[t[2]].cast<double>();
  };
  RestPoint mixed;
  mixed.position = mix(vertices);
  mixed.swell_center = mix(swell_center);
  if (!swell_along.empty()) mixed.swell_along = mix(swell_along);
  mixed.part = part.empty() ? 0 : part[t[0]];
  return mixed;
}

double Surface::SwellReachMm() const {
  float largest_sq = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    largest_sq = std::max(largest_sq, (vertices[i] - swell_center[i]).squaredNorm());
  return std::sqrt(static_cast<double>(largest_sq));
}

void FillGrid(Surface& surface) {
  FillNormals(surface);
  FillTriangles(surface);
}

double ReliefMm(const Eigen::Vector3d& position, double relief_mm, std::uint32_t seed) {
  double sum = 0;
  double amplitude = 2.2 * relief_mm;
  double wave_mm = 14.0;
  for (std::uint32_t octave = 0; octave < 4; ++octave, amplitude *= 0.42, wave_mm *= 0.45)
    sum += amplitude * GradientNoise((position / wave_mm).cast<float>(), seed + octave);
  return sum;
}

}  // namespace pliant::simulation
