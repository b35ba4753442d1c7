// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/surface/placed_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <Eigen/Geometry>

namespace pliant {

double DepthTolerance(const Eigen::Vector3d& in_cam, double sigma, double other_sigma) {
  return kSameSurface * std::hypot(sigma, other_sigma) * in_cam.z() / in_cam.norm();
}

bool PlacedMesh::IsInImage(const Camera& camera, std::size_t vertex) const {
  return pixels[vertex] && camera.Contains(*pixels[vertex]) && depths[vertex] > 0.0;
}

bool PlacedMesh::IsHidden(std::span<const Triangle> triangles, std::size_t vertex, double tolerance) const {
  const Eigen::Vector2d& pixel = *pixels[vertex];
  const int column = std::min(static_cast<int>(std::lround(pixel.x() / step_px)), raster.depth.cols - 1);
  const int row = std::min(static_cast<int>(std::lround(pixel.y() / step_px)), raster.depth.rows - 1);
  const std::int32_t t = raster.triangle.at<std::int32_t>(row, column);
  if (t == kNoTriangle) return false;
  const Triangle& triangle = triangles[static_cast<std::size_t>(t)];
  if (std::ranges::find(triangle, static_cast<std::int32_t>(vertex)) != triangle.end()) return false;
  const auto corner = [&](std::size_t k) { return in_cam[static_cast<std::size_t>(triangle[k])]; };
  const Eigen::Vector3d normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
  const Eigen::Vector3d ray = in_cam[vertex] / depths[vertex];
  const double along = normal.dot(ray);
  const double on_plane = along != 0.0 ? normal.dot(corner(0)) / along : 0.0;
  const double at_node = raster.depth.at<float>(row, column);
  // Seen along the plane it says nothing; then what is at the node does.
  const double depth = on_plane > 0.5 * at_node && on_plane < 2.0 * at_node ? on_plane : at_node;
  return depth < depths[vertex] - tolerance;
}

PlacedMesh PlaceMesh(const Camera& camera, std::vector<Eigen::Vector3d> in_cam, std::span<const Triangle> triangles,
                     const std::vector<bool>& hides, double step_px) {
  PlacedMesh placed;
  placed.step_px = step_px;
  placed.in_cam = std::move(in_cam);
  placed.pixels = camera.Project(placed.in_cam);
  for (const Eigen::Vector3d& point : placed.in_cam) placed.depths.push_back(point.z());
  std::vector<std::optional<Eigen::Vector2d>> hiding = placed.pixels;
  for (std::size_t v = 0; v < hides.size(); ++v)
    if (!hides[v]) hiding[v].reset();
  const auto nodes = [&](int size) { return static_cast<int>(std::floor((size - 1) / step_px)) + 1; };
  placed.raster =
      RasterizeMesh(hiding, placed.depths, triangles, {nodes(camera.width()), nodes(camera.height())}, step_px);
  return placed;
}

}  // namespace pliant
