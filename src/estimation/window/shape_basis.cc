// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/window/shape_basis.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pliant/deformation/graph.h"
#include "pliant/geometry/decompositions.h"

namespace pliant {
namespace {

constexpr std::size_t kNearest = 4;

}  // namespace

std::vector<int> SpreadPositions(const std::vector<Eigen::Vector3d>& positions, const std::vector<int>& from,
                                 std::size_t count) {
  count = std::min(count, from.size());
  std::vector<int> chosen;
  std::vector<double> nearest(from.size(), std::numeric_limits<double>::infinity());
  std::size_t next = 0;
  while (chosen.size() < count) {
    chosen.push_back(from[next]);
    nearest[next] = -1.0;  // not again
    for (std::size_t k = 0; k < from.size(); ++k)
      nearest[k] = std::min(
          nearest[k],
          (positions[static_cast<std::size_t>(from[k])] - positions[static_cast<std::size_t>(chosen.back())]).norm());
    next = static_cast<std::size_t>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

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

void KeepStrongestShapes(int rank, DeformingWindow* window, SurfaceNodes* nodes) {
  const Eigen::Index views = window->coefficients.cols();
  Eigen::MatrixXd second_moment = Eigen::MatrixXd::Zero(window->coefficients.rows(), window->coefficients.rows());
  for (const Eigen::Matrix3Xd& shapes : window->shapes) second_moment += shapes.transpose() * shapes;
  const Eigen::MatrixXd motions = window->coefficients.transpose() * second_moment * window->coefficients;
  const auto eigen = EigenOfSymmetric(motions);  // the strongest last
  const Eigen::MatrixXd strongest = eigen.vectors.rightCols(rank).rowwise().reverse();
  const double length = std::sqrt(static_cast<double>(views));
  const Eigen::MatrixXd change = window->coefficients * strongest / length;
  for (Eigen::Matrix3Xd& shapes : window->shapes) shapes = Eigen::Matrix3Xd(shapes * change);
  Eigen::MatrixXd node_shapes(3 * rank, nodes->shapes.cols());
  for (Eigen::Index n = 0; n < node_shapes.cols(); ++n)
    node_shapes.col(n) = (nodes->shapes.col(n).reshaped(3, change.rows()) * change).reshaped();
  nodes->shapes = node_shapes;
  window->coefficients = length * strongest.transpose();
  window->coefficients.col(0).setZero();  // but for rounding it is
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
