// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/surface/mesh_geometry.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace pliant {
namespace {

constexpr std::int32_t kGone = -1;

struct Edges {
  Eigen::Vector3f first;
  Eigen::Vector3f second;
};

Edges EdgesOf(std::span<const Eigen::Vector3f> vertices, const Triangle& triangle) {
  const auto at = [&](std::size_t k) { return vertices[static_cast<std::size_t>(triangle[k])]; };
  return {at(1) - at(0), at(2) - at(0)};
}

// The edges in the triangle's own plane, the first one along x. Nothing where it has no area.
std::optional<Eigen::Matrix2f> InPlane(const Edges& edges) {
  const float length = edges.first.norm();
  const float area = edges.first.cross(edges.second).norm();
  if (!(area > 0.0F)) return std::nullopt;
  Eigen::Matrix2f columns;
  columns << length, edges.first.dot(edges.second) / length, 0.0F, area / length;
  return columns;
}

}  // namespace

std::vector<Eigen::Vector3f> VertexNormals(std::span<const Eigen::Vector3f> vertices,
                                           std::span<const Triangle> triangles) {
  std::vector<Eigen::Vector3f> normals(vertices.size(), Eigen::Vector3f::Zero());
  for (const Triangle& triangle : triangles) {
    const Edges edges = EdgesOf(vertices, triangle);
    const Eigen::Vector3f normal = edges.first.cross(edges.second);
    for (const std::int32_t v : triangle) normals[static_cast<std::size_t>(v)] += normal;
  }
  for (Eigen::Vector3f& normal : normals) normal.normalize();
  for (const Triangle& triangle : triangles)
    for (const std::int32_t v : triangle) {
      Eigen::Vector3f& normal = normals[static_cast<std::size_t>(v)];
      if (normal.squaredNorm() > 0.5F) continue;
      const Edges edges = EdgesOf(vertices, triangle);
      normal = edges.first.cross(edges.second).normalized();
      if (!(normal.squaredNorm() > 0.5F)) normal = Eigen::Vector3f::UnitZ();
    }
  return normals;
}

Mesh PartOfMesh(const Mesh& mesh, const std::vector<bool>& keep) {
  std::vector<bool> is_used(mesh.vertices.size(), false);
  for (const Triangle& triangle : mesh.triangles)
    if (std::ranges::all_of(triangle, [&](std::int32_t v) { return keep[static_cast<std::size_t>(v)]; }))
      for (const std::int32_t v : triangle) is_used[static_cast<std::size_t>(v)] = true;
  Mesh part;
  std::vector<std::int32_t> becomes(mesh.vertices.size(), kGone);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!is_used[v]) continue;
    becomes[v] = static_cast<std::int32_t>(part.vertices.size());
    part.vertices.push_back(mesh.vertices[v]);
    if (!mesh.normals.empty()) part.normals.push_back(mesh.normals[v]);
    if (!mesh.rgb.empty()) part.rgb.push_back(mesh.rgb[v]);
    if (!mesh.sigmas.empty()) part.sigmas.push_back(mesh.sigmas[v]);
    if (!mesh.ids.empty()) part.ids.push_back(mesh.ids[v]);
    if (!mesh.views.empty()) part.views.push_back(mesh.views[v]);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Triangle moved{};
    for (std::size_t k = 0; k < 3; ++k) moved[k] = becomes[static_cast<std::size_t>(mesh.triangles[t][k])];
    if (std::ranges::any_of(mesh.triangles[t], [&](std::int32_t v) { return !keep[static_cast<std::size_t>(v)]; }))
      continue;
    part.triangles.push_back(moved);
    if (!mesh.texture_uvs.empty()) part.texture_uvs.push_back(mesh.texture_uvs[t]);
  }
  return part;
}

std::vector<TriangleStrain> Strains(std::span<const Eigen::Vector3f> undeformed,
                                    std::span<const Eigen::Vector3f> deformed, std::span<const Triangle> triangles) {
  std::vector<TriangleStrain> strains;
  for (const Triangle& triangle : triangles) {
    const auto before = InPlane(EdgesOf(undeformed, triangle));
    const auto after = InPlane(EdgesOf(deformed, triangle));
    strains.emplace_back();
    if (!before || !after) continue;
    // Singular values of the deformation gradient, from its Cauchy-Green tensor's trace and its own determinant.
    const Eigen::Matrix2f gradient = *after * before->inverse();
    const float half_trace = 0.5F * gradient.squaredNorm();
    const float determinant = gradient.determinant();
    const float root = std::sqrt(std::max(0.0F, half_trace * half_trace - determinant * determinant));
    const float largest = std::sqrt(half_trace + root);
    strains.back() = {determinant - 1.0F, largest, determinant / largest};
  }
  return strains;
}

}  // namespace pliant
