// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/surface/depth_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

#include "pliant/image/brightness.h"
#include "surface/depth_holes.h"

namespace pliant {
namespace {

constexpr std::int32_t kNoVertex = -1;

// Whether the distances of a triangle's corners are those of one surface.
bool IsOneSurface(const Mesh& mesh, const std::array<std::int32_t, 3>& triangle, double largest_step) {
  double least = mesh.vertices[static_cast<std::size_t>(triangle[0])].norm();
  double largest = least;
  for (const std::int32_t v : triangle) {
    const double distance = mesh.vertices[static_cast<std::size_t>(v)].norm();
    least = std::min(least, distance);
    largest = std::max(largest, distance);
  }
  return largest - least <= largest_step * least;
}

void AddNormals(Mesh* mesh) {
  mesh->normals.assign(mesh->vertices.size(), Eigen::Vector3f::Zero());
  for (const auto& triangle : mesh->triangles) {
    const auto at = [&](int k) {
      return mesh->vertices[static_cast<std::size_t>(triangle[static_cast<std::size_t>(k)])];
    };
    const Eigen::Vector3f normal = (at(1) - at(0)).cross(at(2) - at(0));
    for (const std::int32_t v : triangle) mesh->normals[static_cast<std::size_t>(v)] += normal;
  }
  for (std::size_t v = 0; v < mesh->normals.size(); ++v) {
    const float length = mesh->normals[v].norm();
    mesh->normals[v] =
        length > 0.0F ? Eigen::Vector3f(mesh->normals[v] / length) : Eigen::Vector3f(-mesh->vertices[v].normalized());
  }
}

}  // namespace

Mesh MeshOfDepth(const Camera& camera, const DenseDepth& dense, const cv::Mat& image, int step_px) {
  Mesh mesh;
  const int columns = (dense.depth.cols + step_px - 1) / step_px;
  const int rows = (dense.depth.rows + step_px - 1) / step_px;
  std::vector<std::int32_t> vertex_at(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), kNoVertex);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const Eigen::Vector2d pixel(c * step_px, r * step_px);
      const float depth = dense.depth.at<float>(r * step_px, c * step_px);
      const auto ray = camera.Unproject(pixel);
      if (!(depth > 0.0F) || !ray) continue;
      vertex_at[static_cast<std::size_t>(r * columns + c)] = static_cast<std::int32_t>(mesh.vertices.size());
      const Eigen::Vector3d position = *ray * (depth / ray->z());
      mesh.vertices.emplace_back(position.cast<float>());
      mesh.rgb.push_back(ColorAt(image, pixel));
      mesh.sigmas.push_back(dense.sigma.at<float>(r * step_px, c * step_px) * static_cast<float>(position.norm()));
    }
  const double largest_step = step_px * LargestStepOfASurface(camera.MeanFocalLengthPx());
  const auto add = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
    if (a == kNoVertex || b == kNoVertex || c == kNoVertex) return;
    if (IsOneSurface(mesh, {a, b, c}, largest_step)) mesh.triangles.push_back({a, b, c});
  };
  for (int r = 0; r + 1 < rows; ++r)
    for (int c = 0; c + 1 < columns; ++c) {
      const auto at = [&](int dr, int dc) { return vertex_at[static_cast<std::size_t>((r + dr) * columns + c + dc)]; };
      add(at(0, 0), at(1, 0), at(0, 1));
      add(at(1, 0), at(1, 1), at(0, 1));
    }
  AddNormals(&mesh);
  return mesh;
}

}  // namespace pliant
