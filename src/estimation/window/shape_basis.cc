// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/window/shape_basis.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pliant/deformation/graph.h"

namespace pliant {
namespace {

constexpr std::size_t kNearest = 4;

}  // namespace

SurfaceNodes NodesAt(const std::vector<Eigen::Vector3d>& points_in_world, const std::vector<int>& at) {
  SurfaceNodes nodes;
  for (const int point : at) nodes.positions.push_back(points_in_world[static_cast<std::size_t>(point)]);
  return nodes;
}

ShapeSizes SizesOf(const SurfaceNodes& nodes) {
  if (nodes.positions.size() < 2) return {};
  const NeighborLists nearest = NearestNeighbors(nodes.positions, 1);
  double gradients = 0;
  for (std::size_t i = 0; i < nodes.positions.size(); ++i) {
    if (nearest[i].empty()) continue;
    const int j = nearest[i].front();
    const double squared = (nodes.positions[i] - nodes.positions[static_cast<std::size_t>(j)]).squaredNorm();
    if (squared > 0.0)
      gradients += (nodes.shapes.col(static_cast<Eigen::Index>(i)) - nodes.shapes.col(j)).squaredNorm() / squared;
  }
  const auto entries = static_cast<double>(nodes.shapes.size());
  return {std::sqrt(nodes.shapes.squaredNorm() / entries), std::sqrt(gradients / entries)};
}

std::vector<NodesOfPoint> NodesAround(const std::vector<Eigen::Vector3d>& points_in_world,
                                      const std::vector<Eigen::Vector3d>& nodes_in_world) {
  std::vector<NodesOfPoint> around;
  for (const Eigen::Vector3d& point : points_in_world) {
    std::vector<std::pair<double, int>> near;
    for (std::size_t n = 0; n < nodes_in_world.size(); ++n)
      near.emplace_back((nodes_in_world[n] - point).norm(), static_cast<int>(n));
    const std::size_t count = std::min(kNearest + 1, near.size());
    std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
    NodesOfPoint of{.weights = {}, .distance = near.front().first};
    const double reach = near[count - 1].first;
    double sum = 0;
    for (std::size_t k = 0; k + 1 < count; ++k) {
      const double weight = std::pow(1.0 - near[k].first / reach, 2);
      if (!(weight > 0.0)) continue;
      of.weights.push_back({near[k].second, weight});
      sum += weight;
    }
    if (of.weights.empty()) {  // all as far, or a single one
      of.weights.push_back({near.front().second, 1.0});
      sum = 1.0;
    }
    for (NodeWeight& weight : of.weights) weight.weight /= sum;
    around.push_back(std::move(of));
  }
  return around;
}

}  // namespace pliant
