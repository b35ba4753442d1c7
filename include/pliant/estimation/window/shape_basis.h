// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Basis shapes that vary smoothly over the surface: what they are expected to be at a point, from those of the nodes
// around it (docs/method.md, eq. W3).
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "pliant/estimation/window/deforming_window.h"

namespace pliant {

// `count` of those positions whose indices are in `from`, or all of these, spread evenly (farthest point sampling);
// ascending.
std::vector<int> SpreadPositions(const std::vector<Eigen::Vector3d>& positions, const std::vector<int>& from,
                                 std::size_t count);

// At some of the points, without basis shapes.
SurfaceNodes NodesAt(const std::vector<Eigen::Vector3d>& points_in_world, const std::vector<int>& at);

// Root mean squares over the nodes: of a basis shape's components, and of their difference from those of the nearest
// other node by the distance to it. 0 where there are no two nodes.
struct ShapeSizes {
  double size = 0;
  double gradient = 0;
};
ShapeSizes SizesOf(const SurfaceNodes& nodes);

// Makes the window's coefficients and basis shapes, and those of its nodes, the best approximation of its motions with
// `rank` of them (Eckart, Young): the strongest coefficients, of unit mean square, and the shapes that go with them.
// They are zero in the first view.
void KeepStrongestShapes(int rank, DeformingWindow* window, SurfaceNodes* nodes);

struct NodeWeight {
  int node_idx = 0;
  double weight = 0;
};

struct NodesOfPoint {
  std::vector<NodeWeight> weights;  // of its nearest nodes; they sum to 1
  double distance = 0;              // to the nearest one
};

// Weights that fall with the distance and vanish where a node ceases to be among the four nearest (Shepard).
std::vector<NodesOfPoint> NodesAround(const std::vector<Eigen::Vector3d>& points_in_world,
                                      const std::vector<Eigen::Vector3d>& nodes_in_world);

}  // namespace pliant
