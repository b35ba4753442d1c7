// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Where a mesh ends in an image, and which triangles may be added to it there.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_set>
#include <vector>

#include <Eigen/Core>

#include "pliant/surface/mesh_geometry.h"
#include "pliant/surface/placed_mesh.h"

namespace pliant {

// The edges of triangles, each in the direction in which its triangle turns: on one side of a surface none comes twice.
class DirectedEdges {
 public:
  bool Contains(std::int32_t from, std::int32_t to) const { return edges_.contains(KeyOf(from, to)); }
  bool ContainsAnyOf(const Triangle& triangle) const;
  void Add(const Triangle& triangle);

 private:
  static std::uint64_t KeyOf(std::int32_t from, std::int32_t to) {
    return static_cast<std::uint64_t>(from) << 32 | static_cast<std::uint32_t>(to);
  }

  std::unordered_set<std::uint64_t> edges_;
};

class MeshSeam {
 public:
  // `counts`, one entry a vertex: triangles with another one are as if they were not there. `largest_step`: by how much
  // depths of one surface differ at most within a triangle, relative.
  MeshSeam(const PlacedMesh& placed, std::span<const Triangle> triangles, const std::vector<bool>& counts,
           double largest_step);

  // The vertices at the mesh's border that are nearest to a node of the placed mesh's raster, or nearest to one of the
  // `reach` nodes around it on each side.
  std::vector<std::int32_t> BorderAround(int column, int row, int reach) const;
  // Whether a triangle, of which some corners may have been placed later, lies beside the mesh and not on it, faces the
  // camera, and has no edge that two triangles have; it is part of the mesh from then on.
  bool Take(const Triangle& triangle, const PlacedMesh& placed);

 private:
  struct Corner {
    Eigen::Vector2d pixel;
    double inverse_depth = 0;
  };
  using Corners = std::array<Corner, 3>;

  std::size_t CellOf(const Eigen::Vector2d& pixel) const;
  void Cover(const Corners& corners);
  bool Covers(const Eigen::Vector2d& pixel, double inverse_depth) const;

  double step_px_;
  int columns_;
  int rows_;
  double largest_step_;
  DirectedEdges edges_;
  std::vector<std::vector<std::int32_t>> border_;      // vertices by the node that they are nearest to
  std::vector<Corners> covering_;                      // triangles in the image
  std::vector<std::vector<std::size_t>> covering_of_;  // of these, those that reach into the cell of a node
};

}  // namespace pliant
