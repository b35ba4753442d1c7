// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/deformation/graph.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>
#include <utility>

#include <flann/flann.hpp>  // the only file that includes FLANN; OpenCV's headers clash with it

#include "pliant/base/parallel.h"

namespace pliant {
namespace {

using Points = std::span<const Eigen::Vector3d>;

// Distances that differ by less than this ratio count as equal: FLANN sums squares in its own order.
constexpr double kTie = 1e-12;

bool AllFinite(Points points) {
  return std::all_of(points.begin(), points.end(), [](const Eigen::Vector3d& x) { return x.allFinite(); });
}

// Whether the square of every distance is a number.
bool HaveDistances(Points points) {
  return std::ranges::all_of(points, [](const Eigen::Vector3d& x) { return std::isfinite((2 * x).squaredNorm()); });
}

constexpr int kNobody = -1;
constexpr int kQueriesAtOnce = 64;  // by one thread

// The `count` nearest to a position, by distance and then by index, without one of them: breaks ties, at the price of a
// look at every point.
std::vector<int> NearestByScan(Points points, const Eigen::Vector3d& query, int without, int count) {
  std::vector<std::pair<double, int>> others;
  others.reserve(points.size());
  for (int j = 0; j < static_cast<int>(points.size()); ++j)
    if (j != without) others.emplace_back((points[j] - query).squaredNorm(), j);
  std::partial_sort(others.begin(), others.begin() + count, others.end());
  std::vector<int> nearest;
  for (int k = 0; k < count; ++k) nearest.push_back(others[k].second);
  return nearest;
}

// The nearest points of each query position; where `queries_are_points`, each query is the point of its index, which is
// left out.
NeighborLists Nearest(Points points, Points queries, bool queries_are_points, int neighbors, int threads) {
  const int num_points = static_cast<int>(points.size());
  const int num_queries = static_cast<int>(queries.size());
  const int count = std::min(neighbors, num_points - (queries_are_points ? 1 : 0));
  NeighborLists lists(num_queries);
  if (count < 1 || num_queries == 0 || !AllFinite(points) || !AllFinite(queries)) return lists;

  // FLANN does not write to its input, but takes it without const. Vector3d has no padding: rows of three doubles.
  static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double));
  const flann::Matrix<double> data(const_cast<double*>(points.data()->data()), num_points, 3);
  const flann::Matrix<double> query_matrix(const_cast<double*>(queries.data()->data()), num_queries, 3);
  flann::KDTreeSingleIndex<flann::L2_Simple<double>> index(data, flann::KDTreeSingleIndexParams());
  index.buildIndex();

  // A point itself comes back too, and one more tells whether the last neighbor is tied.
  const int wanted = count + (queries_are_points ? 1 : 0);
  const int asked = std::min(wanted + 1, num_points);
  std::vector<std::size_t> indices(static_cast<std::size_t>(num_queries) * asked);
  std::vector<double> distances(indices.size());
  flann::Matrix<std::size_t> index_rows(indices.data(), num_queries, asked);
  flann::Matrix<double> distance_rows(distances.data(), num_queries, asked);
  const auto list_of = [&](int i) {
    const int itself = queries_are_points ? i : kNobody;
    const double* row = distance_rows[i];
    const bool contested = asked > wanted && row[wanted] - row[wanted - 1] <= kTie * row[wanted];
    if (contested) return NearestByScan(points, queries[i], itself, count);
    thread_local std::vector<std::pair<double, int>> others;
    others.clear();
    for (int k = 0; k < asked; ++k)
      if (const int j = static_cast<int>(index_rows[i][k]); j != itself) others.emplace_back(row[k], j);
    std::sort(others.begin(), others.end());
    std::vector<int> nearest(static_cast<std::size_t>(count));
    for (std::size_t k = 0; k < nearest.size(); ++k) nearest[k] = others[k].second;
    return nearest;
  };
  const int blocks = (num_queries + kQueriesAtOnce - 1) / kQueriesAtOnce;
  const auto search = [&](int block) {
    const int begin = block * kQueriesAtOnce;
    const int end = std::min(begin + kQueriesAtOnce, num_queries);
    const auto rows_of = [&](auto& all) { return std::decay_t<decltype(all)>(all[begin], end - begin, all.cols); };
    auto block_indices = rows_of(index_rows);
    auto block_distances = rows_of(distance_rows);
    index.knnSearch(rows_of(query_matrix), block_indices, block_distances, asked,
                    flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED));
    for (int i = begin; i < end; ++i) lists[i] = list_of(i);
  };
  ParallelFor(blocks, threads, search, 1);
  return lists;
}

// The directed pairs of the lists as edges i < j in ascending order, each with the number of its directions.
std::vector<GraphEdge> MergeDirections(const NeighborLists& lists) {
  const auto num_points = static_cast<int>(lists.size());
  std::vector<std::vector<int>> later(lists.size());  // the j > i of each i, twice where both have the other
  for (int i = 0; i < num_points; ++i)
    for (const int j : lists[i]) later[std::min(i, j)].push_back(std::max(i, j));

  std::vector<GraphEdge> edges;
  for (int i = 0; i < num_points; ++i) {
    std::sort(later[i].begin(), later[i].end());
    for (const int j : later[i]) {
      if (!edges.empty() && edges.back().i == i && edges.back().j == j) {
        edges.back().multiplicity = 2;
      } else {
        edges.push_back({.i = i, .j = j});
      }
    }
  }
  return edges;
}

}  // namespace

NeighborLists NearestNeighbors(Points positions, int count) { return Nearest(positions, positions, true, count, 1); }

NeighborLists NearestNeighborsApart(Points positions, double min_distance, int count) {
  NeighborLists neighbors(positions.size());
  std::vector<std::pair<double, int>> others;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    others.clear();
    for (std::size_t j = 0; j < positions.size(); ++j) {
      const double distance = (positions[i] - positions[j]).norm();
      if (j != i && distance >= min_distance) others.emplace_back(distance, static_cast<int>(j));
    }
    const auto nearest = others.begin() + std::min<std::ptrdiff_t>(count, std::ssize(others));
    std::partial_sort(others.begin(), nearest, others.end());
    for (auto other = others.begin(); other != nearest; ++other) neighbors[i].push_back(other->second);
  }
  return neighbors;
}

NeighborLists NearestNeighbors(Points positions, Points queries, int count) {
  return Nearest(positions, queries, false, count, 1);
}

void GraphOptions::List(OptionTable& table) {
  table.BeginGroup("Deformation", "the graph that ties each point to its neighbors");
  table.Add("neighbors", &neighbors, "points", "K, how many nearest neighbors each point is tied to", 1, 1000);
  table.Add("sigma_mm", &sigma_mm, "mm", "distance over which neighbors move alike: w = exp(-d^2 / (2 sigma^2))", 1e-6,
            1e6);
  table.AddChoice("cut_edges", &cut_edges,
                  "whether edges are left out whose length has left its rest length (surfaces that slide or part)");
  table.Add("max_stretch", &max_stretch, "ratio", "with cut_edges = stretch: largest |length / rest length - 1| kept",
            0.0, 1e6);
}

Result<DeformationGraph> BuildDeformationGraph(Points positions, Points rest_positions, const GraphOptions& options,
                                               int threads) {
  if (!rest_positions.empty() && rest_positions.size() != positions.size())
    return {ErrorCode::kMismatch, "the deformation graph was given " + std::to_string(positions.size()) +
                                      " positions but " + std::to_string(rest_positions.size()) + " rest positions"};
  if (!AllFinite(positions) || !AllFinite(rest_positions))
    return {ErrorCode::kInvalidArgument, "the deformation graph was given a position that is not a finite number"};

  if (!HaveDistances(positions) || !HaveDistances(rest_positions))
    return {ErrorCode::kInvalidArgument,
            "the deformation graph was given a position so far away that squares of distances are not finite; give "
            "millimeters"};

  DeformationGraph graph;
  graph.num_points = static_cast<int>(positions.size());
  graph.edges = MergeDirections(Nearest(positions, positions, true, options.neighbors, threads));
  const double exponent = -1.0 / (2.0 * options.sigma_mm * options.sigma_mm);
  for (GraphEdge& edge : graph.edges) {
    const double squared_length = (positions[edge.i] - positions[edge.j]).squaredNorm();
    edge.weight = std::exp(exponent * squared_length);
    edge.rest_length_mm =
        rest_positions.empty() ? std::sqrt(squared_length) : (rest_positions[edge.i] - rest_positions[edge.j]).norm();
  }
  if (options.cut_edges == EdgeCut::kStretch && !rest_positions.empty()) {
    graph.cut = static_cast<int>(std::erase_if(graph.edges, [&](const GraphEdge& edge) {
      const double length = (positions[edge.i] - positions[edge.j]).norm();
      return std::abs(length - edge.rest_length_mm) > options.max_stretch * edge.rest_length_mm;
    }));
  }
  return graph;
}

}  // namespace pliant
