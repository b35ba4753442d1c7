// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "refinement/bundle.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <ceres/iteration_callback.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/ordered_groups.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <ceres/types.h>

#include "pliant/residuals/pose_increment.h"
#include "refinement/bundle_costs.h"

namespace pliant {
namespace {

constexpr double kLossScale = 2.0;           // Cauchy, in standard deviations
constexpr double kMinDistance = 0.04;        // of nodes and points, by the median distance from the camera
constexpr double kFunctionTolerance = 1e-3;  // what is left changes depths by less than their noise
constexpr int kMaxDenseParameters = 1000;

class Callback final : public ceres::IterationCallback {
 public:
  explicit Callback(const std::function<bool(double)>& function) : function_(function) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    return !function_ || function_(summary.cost) ? ceres::SOLVER_CONTINUE : ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }

 private:
  const std::function<bool(double)>& function_;
};

// Poses as increments about the mean of the points that a view sees.
std::vector<PoseIncrement> PosesOf(const Recording& recording, const BundleState& state) {
  std::vector<Eigen::Vector3d> sums(recording.times.size(), Eigen::Vector3d::Zero());
  std::vector<double> counts(recording.times.size(), 0.0);
  for (const RecordedObservation& observation : recording.observations) {
    sums[static_cast<std::size_t>(observation.view_idx)] += state.Position(observation.point_idx, observation.view_idx);
    ++counts[static_cast<std::size_t>(observation.view_idx)];
  }
  std::vector<PoseIncrement> poses;
  for (std::size_t v = 0; v < sums.size(); ++v)
    poses.emplace_back(state.cams_from_world[v], counts[v] > 0.0 ? Eigen::Vector3d(sums[v] / counts[v])
                                                                 : state.cams_from_world[v].OriginInSource());
  return poses;
}

class BundleProblem {
 public:
  BundleProblem(const Camera& camera, const Recording& recording, const std::vector<bool>& used,
                const BundleGraph& graph, const BundleSigmas& sigmas, double distance, BundleState* state)
      : recording_(recording),
        graph_(graph),
        sigmas_(sigmas),
        distance_(distance),
        state_(state),
        rank_(state->rank()),
        poses_(PosesOf(recording, *state)),
        is_in_problem_(state->rest_positions.size(), false),
        loss_(kLossScale) {
    CopyFromState();
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem_ = std::make_unique<ceres::Problem>(options);
    AddReprojection(camera, used);
    AddDistances(used);
    if (rank_ > 0) {
      AddNodes();
      AddCoefficients();
    }
    HoldFirstPose();
  }

  Result<BundleSummary> Solve(int max_iterations, const std::function<bool(double)>& callback) {
    ceres::Solver::Options options;
    options.max_num_iterations = max_iterations;
    const auto dense = static_cast<int>(poses_.size()) * (6 + rank_) + static_cast<int>(nodes_.size()) * 3 * rank_;
    options.linear_solver_type = dense <= kMaxDenseParameters ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
    options.linear_solver_ordering = PointsFirst();
    if (rank_ > 0) {  // every point at its best after each step: coefficients against shapes is a curved valley
      options.use_inner_iterations = true;
      options.inner_iteration_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
      for (std::size_t i = 0; i < points_.size(); ++i)
        if (is_in_problem_[i]) options.inner_iteration_ordering->AddElementToGroup(points_[i], 0);
    }
    options.function_tolerance = kFunctionTolerance;
    options.num_threads = 1;  // the order of sums, and so the result, depends on no number of threads
    options.logging_type = ceres::SILENT;
    Callback on_iteration(callback);
    options.callbacks.push_back(&on_iteration);
    ceres::Solver::Summary summary;
    ceres::Solve(options, problem_.get(), &summary);
    if (!summary.IsSolutionUsable())
      return Status(ErrorCode::kDegenerate, "the refinement found no step that lowers its cost: " + summary.message);
    CopyToState();
    return BundleSummary{summary.initial_cost, summary.final_cost};
  }

 private:
  void HoldFirstPose() {
    double* const first = views_.front();
    if (!problem_->HasParameterBlock(first)) return;
    if (rank_ == 0) return problem_->SetParameterBlockConstant(first);
    problem_->SetManifold(first, new ceres::SubsetManifold(6 + rank_, {0, 1, 2, 3, 4, 5}));
  }

  // Blocks stand in one array: Ceres orders them by their address, and with it its sums.
  void CopyFromState() {
    const auto rank = static_cast<std::size_t>(rank_);
    parameters_.assign(poses_.size() * (6 + rank) + state_->rest_positions.size() * (3 + 3 * rank) +
                           state_->nodes.positions.size() * 3 * rank,
                       0.0);
    double* next = parameters_.data();
    for (std::size_t v = 0; v < poses_.size(); ++v, next += 6 + rank) {
      views_.push_back(next);
      if (rank_ > 0) Coefficients(v) = state_->coefficients.col(static_cast<Eigen::Index>(v));
    }
    for (std::size_t i = 0; i < state_->rest_positions.size(); ++i, next += 3 + 3 * rank) {
      points_.push_back(next);
      RestPosition(i) = state_->rest_positions[i];
      if (rank_ > 0) Shapes(points_[i] + 3) = state_->shapes[i].reshaped();
    }
    for (std::size_t n = 0; n < state_->nodes.positions.size(); ++n, next += 3 * rank) {
      nodes_.push_back(next);
      Shapes(next) = state_->nodes.shapes.col(static_cast<Eigen::Index>(n));
    }
  }

  void CopyToState() {
    for (std::size_t v = 0; v < poses_.size(); ++v) {
      state_->cams_from_world[v] = poses_[v].Pose(Eigen::Map<const Vector6d>(views_[v]));
      if (rank_ > 0) state_->coefficients.col(static_cast<Eigen::Index>(v)) = Coefficients(v);
    }
    for (std::size_t i = 0; i < points_.size(); ++i) {
      state_->rest_positions[i] = RestPosition(i);
      if (rank_ > 0) state_->shapes[i] = Shapes(points_[i] + 3).reshaped(3, rank_);
    }
    for (std::size_t n = 0; n < nodes_.size(); ++n)
      state_->nodes.shapes.col(static_cast<Eigen::Index>(n)) = Shapes(nodes_[n]);
  }

  Eigen::Map<Eigen::VectorXd> Coefficients(std::size_t view) { return {views_[view] + 6, rank_}; }
  Eigen::Map<Eigen::Vector3d> RestPosition(std::size_t point) { return Eigen::Map<Eigen::Vector3d>(points_[point]); }
  Eigen::Map<Eigen::VectorXd> Shapes(double* first) const { return {first, 3 * rank_}; }

  std::shared_ptr<ceres::ParameterBlockOrdering> PointsFirst() {
    auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    std::vector<double*> blocks;
    problem_->GetParameterBlocks(&blocks);
    for (double* const block : blocks) ordering->AddElementToGroup(block, 1);
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (is_in_problem_[i]) ordering->AddElementToGroup(points_[i], 0);
    return ordering;
  }

  void AddReprojection(const Camera& camera, const std::vector<bool>& used) {
    for (std::size_t o = 0; o < used.size(); ++o) {
      if (!used[o]) continue;
      const RecordedObservation& observation = recording_.observations[o];
      const auto view = static_cast<std::size_t>(observation.view_idx);
      const auto point = static_cast<std::size_t>(observation.point_idx);
      problem_->AddResidualBlock(
          NewBundleReprojectionCost(camera, poses_[view], observation.pixel, sigmas_.noise_px, rank_), &loss_,
          views_[view], points_[point]);
      is_in_problem_[point] = true;
    }
  }

  // (F7), in the view in the middle of a track.
  void AddDistances(const std::vector<bool>& used) {
    std::vector<std::vector<int>> views(points_.size());
    for (std::size_t o = 0; o < used.size(); ++o)
      if (used[o])
        views[static_cast<std::size_t>(recording_.observations[o].point_idx)].push_back(
            recording_.observations[o].view_idx);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!is_in_problem_[i]) continue;
      const auto view = static_cast<std::size_t>(views[i][views[i].size() / 2]);
      const double distance = (recording_.cams_from_world[view] * recording_.rest_positions[i]).norm();
      problem_->AddResidualBlock(NewDistanceCost(poses_[view], distance, sigmas_.log_distance, rank_), nullptr,
                                 views_[view], points_[i]);
    }
  }

  // (F3) to (F5).
  void AddNodes() {
    const double least = kMinDistance * distance_;
    const auto count = static_cast<double>(nodes_.size());
    const auto points = static_cast<double>(std::count(is_in_problem_.begin(), is_in_problem_.end(), true));
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!is_in_problem_[i]) continue;
      const NodesOfPoint& around = graph_.nodes_of_point[i];
      std::vector<double> weights;
      std::vector<double*> blocks = {points_[i]};
      for (const NodeWeight& node : around.weights) {
        weights.push_back(node.weight);
        blocks.push_back(nodes_[static_cast<std::size_t>(node.node_idx)]);
      }
      const double scale = 1.0 / (sigmas_.gradient * std::max(least, around.distance));
      problem_->AddResidualBlock(NewNodePullCost(scale, weights, rank_), nullptr, blocks);
    }
    const double share = std::sqrt(points / static_cast<double>(graph_.edges.size()));
    for (const auto& [n, k] : graph_.edges) {
      const double apart =
          (state_->nodes.positions[static_cast<std::size_t>(n)] - state_->nodes.positions[static_cast<std::size_t>(k)])
              .norm();
      const double weight = share / (sigmas_.gradient * std::max(least, apart));
      problem_->AddResidualBlock(NewWeightedSumCost({weight, -weight}, 3 * rank_, 3 * rank_), nullptr,
                                 nodes_[static_cast<std::size_t>(n)], nodes_[static_cast<std::size_t>(k)]);
    }
    for (double* const node : nodes_)
      problem_->AddResidualBlock(
          NewWeightedSumCost({std::sqrt(points / count) / (sigmas_.size * distance_)}, 3 * rank_, 3 * rank_), nullptr,
          node);
  }

  // (F6), by divided differences.
  void AddCoefficients() {
    for (std::size_t v = 0; v < views_.size(); ++v) {
      problem_->AddResidualBlock(NewWeightedSumCost({1.0}, 6 + rank_, rank_), nullptr, views_[v]);
      if (v < 2) continue;
      const double before = recording_.times[v - 1] - recording_.times[v - 2];
      const double after = recording_.times[v] - recording_.times[v - 1];
      const double unit = 0.5 * (before + after) * sigmas_.acceleration;
      problem_->AddResidualBlock(
          NewWeightedSumCost(
              {1.0 / (before * unit), -1.0 / (before * unit) - 1.0 / (after * unit), 1.0 / (after * unit)}, 6 + rank_,
              rank_),
          nullptr, views_[v - 2], views_[v - 1], views_[v]);
    }
  }

  const Recording& recording_;
  const BundleGraph& graph_;
  BundleSigmas sigmas_;
  double distance_;
  BundleState* state_;
  int rank_;
  std::vector<PoseIncrement> poses_;
  std::vector<double> parameters_;
  std::vector<double*> views_;       // pose increment and temporal coefficients
  std::vector<double*> points_;      // rest position and basis shapes
  std::vector<double*> nodes_;       // basis shapes
  std::vector<bool> is_in_problem_;  // a point each
  ceres::CauchyLoss loss_;
  std::unique_ptr<ceres::Problem> problem_;
};

}  // namespace

Eigen::Vector3d BundleState::Position(int point_idx, int view_idx) const {
  const auto i = static_cast<std::size_t>(point_idx);
  if (rank() == 0) return rest_positions[i];
  return rest_positions[i] + shapes[i] * coefficients.col(view_idx);
}

Result<BundleSummary> SolveBundle(const Camera& camera, const Recording& recording, const std::vector<bool>& used,
                                  const BundleGraph& graph, const BundleSigmas& sigmas, double distance,
                                  int max_iterations, const std::function<bool(double)>& callback, BundleState* state) {
  return BundleProblem(camera, recording, used, graph, sigmas, distance, state).Solve(max_iterations, callback);
}

std::vector<Eigen::Vector2d> ReprojectionErrors(const Camera& camera, const Recording& recording,
                                                const BundleState& state) {
  std::vector<Eigen::Vector2d> errors;
  errors.reserve(recording.observations.size());
  for (const RecordedObservation& observation : recording.observations) {
    const auto pixel = camera.Project(state.cams_from_world[static_cast<std::size_t>(observation.view_idx)] *
                                      state.Position(observation.point_idx, observation.view_idx));
    errors.push_back(pixel ? Eigen::Vector2d(*pixel - observation.pixel)
                           : Eigen::Vector2d(static_cast<double>(camera.width()), 0.0));
  }
  return errors;
}

}  // namespace pliant
