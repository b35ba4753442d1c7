// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "pliant/deformation/graph.h"
#include "refinement/bundle.h"

namespace pliant {
namespace {

constexpr int kSweeps = 30;
constexpr double kRidge = 1e-3;  // by the mean square displacement
constexpr int kMinNodes = 8;
constexpr int kMinViewsOfNode = 5;

// The displacement of a point from its rest position in a view.
struct Motion {
  int view_idx = 0;
  int point_idx = 0;
  Eigen::Vector3d displacement;
};

// Alternating least squares for X_i(v) - X_i = sum_r c_r(v) m_ir, where not every point is seen in every view. The
// coefficients start as the slowest cosines over the recording, and end with unit mean square.
void Factorize(const std::vector<Motion>& motions, BundleState* state) {
  const auto rank = state->coefficients.rows();
  const auto views = state->coefficients.cols();
  double square = 0;
  for (const Motion& motion : motions) square += motion.displacement.squaredNorm();
  const double ridge = kRidge * (square / static_cast<double>(std::max<std::size_t>(1, motions.size())) + 1e-12);
  for (Eigen::Index v = 0; v < views; ++v)
    for (Eigen::Index r = 0; r < rank; ++r)
      state->coefficients(r, v) =
          std::numbers::sqrt2 * std::cos(std::numbers::pi * static_cast<double>(r + 1) *
                                         (static_cast<double>(v) + 0.5) / static_cast<double>(views));
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    std::vector<Eigen::MatrixXd> normal(state->shapes.size(), Eigen::MatrixXd::Identity(rank, rank));
    std::vector<Eigen::MatrixXd> right(state->shapes.size(), Eigen::MatrixXd::Zero(3, rank));
    for (const Motion& motion : motions) {
      const auto i = static_cast<std::size_t>(motion.point_idx);
      const Eigen::VectorXd c = state->coefficients.col(motion.view_idx);
      normal[i] += c * c.transpose();
      right[i] += motion.displacement * c.transpose();
    }
    for (std::size_t i = 0; i < state->shapes.size(); ++i)
      state->shapes[i] = normal[i].ldlt().solve(right[i].transpose()).transpose();
    std::vector<Eigen::MatrixXd> normal_of_view(static_cast<std::size_t>(views),
                                                ridge * Eigen::MatrixXd::Identity(rank, rank));
    Eigen::MatrixXd right_of_view = Eigen::MatrixXd::Zero(rank, views);
    for (const Motion& motion : motions) {
      const Eigen::Matrix3Xd& shape = state->shapes[static_cast<std::size_t>(motion.point_idx)];
      normal_of_view[static_cast<std::size_t>(motion.view_idx)] += shape.transpose() * shape;
      right_of_view.col(motion.view_idx) += shape.transpose() * motion.displacement;
    }
    for (Eigen::Index v = 0; v < views; ++v)
      state->coefficients.col(v) = normal_of_view[static_cast<std::size_t>(v)].ldlt().solve(right_of_view.col(v));
    for (Eigen::Index r = 0; r < rank; ++r) {
      const double rms = std::sqrt(state->coefficients.row(r).squaredNorm() / static_cast<double>(views));
      if (!(rms > 0.0)) continue;
      state->coefficients.row(r) /= rms;
      for (Eigen::Matrix3Xd& shape : state->shapes) shape.col(r) *= rms;
    }
  }
}

std::vector<int> ChooseNodes(const Recording& recording, int nodes_in_view) {
  const std::vector<int> views = CountViews(recording, std::vector<bool>(recording.observations.size(), true));
  // Of a few frames: those that are seen most often.
  const int most = views.empty() ? 0 : *std::ranges::max_element(views);
  std::vector<int> candidates;
  for (std::size_t i = 0; i < views.size(); ++i)
    if (views[i] >= std::min(kMinViewsOfNode, most)) candidates.push_back(static_cast<int>(i));
  const double in_view =
      static_cast<double>(recording.observations.size()) / static_cast<double>(recording.times.size());
  const double wanted = nodes_in_view * static_cast<double>(candidates.size()) / std::max(1.0, in_view);
  const auto count = static_cast<std::size_t>(std::lround(std::max<double>(kMinNodes, wanted)));
  return SpreadPositions(recording.rest_positions, candidates, count);
}

}  // namespace

BundleState DeformingStart(const Recording& recording, int rank, int nodes_in_view) {
  BundleState state;
  state.cams_from_world = recording.cams_from_world;
  state.rest_positions = recording.rest_positions;
  state.coefficients.setZero(rank, static_cast<Eigen::Index>(recording.times.size()));
  state.shapes.assign(recording.rest_positions.size(), Eigen::Matrix3Xd::Zero(3, rank));
  std::vector<Motion> motions;
  for (const RecordedObservation& o : recording.observations)
    motions.push_back(
        {o.view_idx, o.point_idx, o.position - recording.rest_positions[static_cast<std::size_t>(o.point_idx)]});
  Factorize(motions, &state);
  const std::vector<int> nodes = ChooseNodes(recording, nodes_in_view);
  state.nodes = NodesAt(recording.rest_positions, nodes);
  state.nodes.shapes.resize(3 * rank, static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t n = 0; n < nodes.size(); ++n)
    state.nodes.shapes.col(static_cast<Eigen::Index>(n)) = state.shapes[static_cast<std::size_t>(nodes[n])].reshaped();
  return state;
}

BundleGraph MakeGraph(const BundleState& state, int neighbors) {
  BundleGraph graph;
  if (state.nodes.positions.empty()) return graph;
  graph.nodes_of_point = NodesAround(state.rest_positions, state.nodes.positions);
  const NeighborLists nearest = NearestNeighbors(state.nodes.positions, neighbors);
  for (std::size_t n = 0; n < nearest.size(); ++n)
    for (const int other : nearest[n]) graph.edges.emplace_back(static_cast<int>(n), other);
  return graph;
}

}  // namespace pliant
