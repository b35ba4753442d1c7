// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The deformation graph: every point is tied to its K nearest neighbors in 3D, the nearer the more strongly
// (docs/method.md, eq. D1 to D3).
//
// The paper sums over directed pairs (i, j), j among the neighbors of i. Both directions of a pair have the same
// residual, so here a pair is ONE edge i < j, whose multiplicity (1 or 2) says how many directions it stands for: a sum
// over edges of multiplicity * f(edge) is the paper's sum exactly.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/options.h"
#include "pliant/base/status.h"

namespace pliant {

enum class EdgeCut {
  kOff,      // every edge of the K nearest neighbors is used
  kStretch,  // an edge whose length has left its rest length by more than a ratio is left out
};

template <>
struct EnumNames<EdgeCut> {
  static constexpr std::array kNames = {std::pair{EdgeCut::kOff, std::string_view("off")},
                                        std::pair{EdgeCut::kStretch, std::string_view("stretch")}};
};

struct GraphOptions {
  int neighbors = 20;      // K
  double sigma_mm = 15.0;  // reach of the weights
  EdgeCut cut_edges = EdgeCut::kOff;
  double max_stretch = 0.3;  // |length / rest length - 1| beyond which an edge is cut

  void List(OptionTable& table);  // group "Deformation"
};

// A pair of points, i < j: positions in the span that the graph was built from.
struct GraphEdge {
  int i = 0;
  int j = 0;
  int multiplicity = 1;       // 2 when each is among the other's K nearest, else 1
  double weight = 1;          // w_ij in (0, 1], eq. D2
  double rest_length_mm = 0;  // |R_i - R_j| at rest; the present length when no rest positions are given
};

struct DeformationGraph {
  int num_points = 0;
  std::vector<GraphEdge> edges;  // sorted by (i, j), each pair once
  int cut = 0;                   // edges left out for their stretch
};

// The `count` nearest other points of each, nearest first, at equal distance in the order of their index; fewer where
// there are not as many, and none at all where a position is not finite. The search is exact.
using NeighborLists = std::vector<std::vector<int>>;
NeighborLists NearestNeighbors(std::span<const Eigen::Vector3d> positions, int count);

// The `count` nearest of `positions` to each of `queries`, nearest first; otherwise as above.
NeighborLists NearestNeighbors(std::span<const Eigen::Vector3d> positions, std::span<const Eigen::Vector3d> queries,
                               int count);

// The `count` nearest other points of each that are at least `min_distance` away, nearest first; otherwise as the
// first. Takes time by the square of the number of points.
NeighborLists NearestNeighborsApart(std::span<const Eigen::Vector3d> positions, double min_distance, int count);

// The graph of `positions` (mm, any one frame). `rest_positions` are the same points undeformed; they may be empty when
// nothing asks for them, and then rest lengths are the present lengths and no edge is cut. The search is exact, and
// neighbors at equal distance are taken in the order of their index, so the answer depends on nothing but the input.
// With N <= K points everyone is everyone's neighbor; with none or one there are no edges. It does not depend on the
// number of threads (at least 1) either. Fails with kInvalidArgument for positions that are not finite, or
// so far away that squares of distances are not, and with kMismatch for counts that differ.
Result<DeformationGraph> BuildDeformationGraph(std::span<const Eigen::Vector3d> positions,
                                               std::span<const Eigen::Vector3d> rest_positions,
                                               const GraphOptions& options, int threads = 1);

}  // namespace pliant
