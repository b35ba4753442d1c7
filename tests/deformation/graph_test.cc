// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/deformation/graph.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "pliant/base/random.h"

namespace pliant {
namespace {

using Points = std::vector<Eigen::Vector3d>;

constexpr double kRounding = 1e-12;  // of weights in (0, 1] and sums of a few thousand of them, relative

Points RandomPoints(int count, std::uint64_t seed) {
  Random random(seed);
  Points points;
  for (int i = 0; i < count; ++i)
    points.emplace_back(random.Uniform(-30, 30), random.Uniform(-30, 30), random.Uniform(40, 60));
  return points;
}

// The definition: for each point all others sorted by distance, then index; the first K.
std::vector<std::vector<int>> NeighborsByDefinition(const Points& points, int neighbors) {
  std::vector<std::vector<int>> lists(points.size());
  for (int i = 0; i < static_cast<int>(points.size()); ++i) {
    std::vector<std::pair<double, int>> others;
    for (int j = 0; j < static_cast<int>(points.size()); ++j)
      if (j != i) others.emplace_back((points[i] - points[j]).squaredNorm(), j);
    std::sort(others.begin(), others.end());
    for (int k = 0; k < std::min<int>(neighbors, static_cast<int>(others.size())); ++k)
      lists[i].push_back(others[k].second);
  }
  return lists;
}

void ExpectEdgesByDefinition(const Points& points, const GraphOptions& options) {
  const auto graph = BuildDeformationGraph(points, {}, options);
  ASSERT_TRUE(graph.ok());
  std::map<std::pair<int, int>, int> expected;
  const auto lists = NeighborsByDefinition(points, options.neighbors);
  EXPECT_EQ(NearestNeighbors(points, options.neighbors), lists);
  for (int i = 0; i < static_cast<int>(lists.size()); ++i)
    for (const int j : lists[i]) ++expected[std::minmax(i, j)];
  ASSERT_EQ(graph->edges.size(), expected.size());
  auto edge = graph->edges.begin();
  for (const auto& [pair, multiplicity] : expected) {
    EXPECT_EQ(std::pair(edge->i, edge->j), pair);
    EXPECT_EQ(edge->multiplicity, multiplicity);
    ++edge;
  }
}

TEST(DeformationGraph, HasTheNearestNeighborsOfEveryPoint) { ExpectEdgesByDefinition(RandomPoints(400, 1), {}); }

TEST(NearestNeighbors, OfPositionsAreAsOfPoints) {
  const Points points = RandomPoints(300, 1);
  Points positions = RandomPoints(40, 2);
  positions.push_back(points[7]);
  const NeighborLists lists = NearestNeighbors(points, positions, 8);
  ASSERT_EQ(lists.size(), positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    Points all = points;  // the position is one point more, whose neighbors they are
    all.push_back(positions[i]);
    EXPECT_EQ(lists[i], NeighborsByDefinition(all, 8).back()) << i;
  }
  EXPECT_EQ(lists.back().front(), 7);  // a position that is a point finds it
  EXPECT_EQ(NearestNeighbors(points, Points{}, 8).size(), 0U);
  EXPECT_EQ(NearestNeighbors(Points{{0, 0, 0}}, Points{{1, 0, 0}}, 8), (NeighborLists{{0}}));
  EXPECT_EQ(NearestNeighbors(Points{}, Points{{1, 0, 0}}, 8), (NeighborLists{{}}));
}

TEST(DeformationGraph, BreaksTiesByIndex) {
  Points grid;  // every neighborhood of a regular grid is full of ties
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 12; ++x) grid.emplace_back(2.0 * x, 2.0 * y, 50.0);
  ExpectEdgesByDefinition(grid, {});
  const Points coincident(40, Eigen::Vector3d(1, 2, 50));
  ExpectEdgesByDefinition(coincident, {});
}

TEST(DeformationGraph, SumOverEdgesIsTheDirectedSum) {
  const Points points = RandomPoints(300, 2);
  const GraphOptions options;
  const auto graph = BuildDeformationGraph(points, {}, options);
  ASSERT_TRUE(graph.ok());
  double directed = 0;
  const auto lists = NeighborsByDefinition(points, options.neighbors);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const int j : lists[i])
      directed += std::exp(-(points[i] - points[j]).squaredNorm() / (2 * options.sigma_mm * options.sigma_mm));
  double merged = 0;
  for (const GraphEdge& edge : graph->edges) merged += edge.multiplicity * edge.weight;
  EXPECT_NEAR(merged, directed, kRounding * directed);
}

TEST(DeformationGraph, TiesEveryoneToEveryoneWhenThereAreFewerPointsThanNeighbors) {
  for (const int count : {0, 1, 2, 3, 15, 20, 21, 22}) {
    const Points points = RandomPoints(count, 3);
    const auto graph = BuildDeformationGraph(points, {}, {});
    ASSERT_TRUE(graph.ok());
    EXPECT_EQ(graph->num_points, count);
    if (count <= 21) {
      EXPECT_EQ(static_cast<int>(graph->edges.size()), count * std::max(0, count - 1) / 2);
    }
    ExpectEdgesByDefinition(points, {});
  }
}

TEST(DeformationGraph, CutsEdgesThatStretched) {
  const Points rest = RandomPoints(200, 4);
  Points parted = rest;  // the right half slides away from the left one
  for (Eigen::Vector3d& point : parted)
    if (point.x() > 0) point.y() += 3.0;
  GraphOptions options;
  const auto whole = BuildDeformationGraph(parted, rest, options);
  options.cut_edges = EdgeCut::kStretch;
  options.max_stretch = 0.1;
  const auto cut = BuildDeformationGraph(parted, rest, options);
  ASSERT_TRUE(whole.ok() && cut.ok());
  EXPECT_EQ(whole->cut, 0);
  EXPECT_GT(cut->cut, 0);
  EXPECT_EQ(cut->edges.size() + cut->cut, whole->edges.size());
  ASSERT_FALSE(cut->edges.empty());
  for (const GraphEdge& edge : cut->edges) {
    const double stretch = (parted[edge.i] - parted[edge.j]).norm() / edge.rest_length_mm - 1;
    EXPECT_LE(std::abs(stretch), options.max_stretch);
    EXPECT_DOUBLE_EQ(edge.rest_length_mm, (rest[edge.i] - rest[edge.j]).norm());
  }
  const auto still = BuildDeformationGraph(rest, rest, options);
  ASSERT_TRUE(still.ok());
  EXPECT_EQ(still->cut, 0);
}

TEST(DeformationGraph, RefusesBadInput) {
  Points points = RandomPoints(30, 5);
  const Points fewer(points.begin(), points.end() - 1);
  EXPECT_EQ(BuildDeformationGraph(points, fewer, {}).status().code(), ErrorCode::kMismatch);
  for (const double far : {1e154, -1e200}) {  // the square of a distance overflows
    points[7].y() = far;
    EXPECT_EQ(BuildDeformationGraph(points, {}, {}).status().code(), ErrorCode::kInvalidArgument);
    EXPECT_EQ(BuildDeformationGraph(RandomPoints(30, 5), points, {}).status().code(), ErrorCode::kInvalidArgument);
  }
  points[7].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(BuildDeformationGraph(points, {}, {}).status().code(), ErrorCode::kInvalidArgument);
}

TEST(GraphOptions, ListsTheOptionsUnderTheirNames) {
  GraphOptions options;
  OptionTable table;
  options.List(table);
  EXPECT_TRUE(table.Set("Deformation.neighbors", "8").ok());
  EXPECT_TRUE(table.Set("Deformation.cut_edges", "stretch").ok());
  EXPECT_EQ(options.neighbors, 8);
  EXPECT_EQ(options.cut_edges, EdgeCut::kStretch);
  EXPECT_FALSE(table.Set("Deformation.sigma_mm", "0").ok());
}

TEST(NearestNeighborsApart, LeavesOutTheOnesThatAreTooNear) {
  const std::vector<Eigen::Vector3d> positions = {{0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {6, 0, 0}, {-4, 0, 0}};
  const NeighborLists neighbors = NearestNeighborsApart(positions, 2, 2);
  EXPECT_EQ(neighbors[0], (std::vector<int>{2, 4}));
  EXPECT_EQ(neighbors[1], (std::vector<int>{2, 3}));
  EXPECT_EQ(neighbors[4], (std::vector<int>{0, 1}));
  EXPECT_TRUE(NearestNeighborsApart(positions, 20, 2)[0].empty());
}

}  // namespace
}  // namespace pliant
