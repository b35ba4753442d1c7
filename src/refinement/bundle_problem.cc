// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "refinement/bundle_problem.h"

#include <algorithm>
#include <cmath>

#include <ceres/iteration_callback.h>
#include <ceres/manifold.h>
#include <ceres/solver.h>
#include <ceres/types.h>

#include "refinement/bundle_costs.h"
#include "refinement/one_openmp_thread.h"

namespace pliant {
namespace {

constexpr double kMinDistance = 0.04;      // of nodes and points, by the median distance from the camera
constexpr int kMaxDenseParameters = 2000;  // above it most pairs of views share no point

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

}  // namespace

BundleProblem::BundleProblem(const BundleInput& input, BundleState* state)
    : input_(input),
      state_(state),
      rank_(state->rank()),
      poses_(PosesOf(input.recording, *state)),
      is_view_in_problem_(poses_.size(), false),
      is_point_in_problem_(state->rest_positions.size(), false),
      loss_(kBundleLossScale) {
  CopyFromState();
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_ = std::make_unique<ceres::Problem>(options);
  AddReprojection();
  AddDistances();
  if (rank_ > 0) {
    AddNodes();
    AddCoefficients();
  }
  HoldFirstPose();
  if (input.part != BundlePart::kAll) Hold(nodes_);
  if (input.part == BundlePart::kViews) Hold(points_);
  if (input.part == BundlePart::kPoints) Hold(views_);
}

Result<BundleSummary> BundleProblem::Solve(int max_iterations, const std::function<bool(double)>& callback) {
  ceres::Solver::Options options;
  options.max_num_iterations = max_iterations;
  SetLinearSolver(&options);
  options.function_tolerance = input_.function_tolerance;
  options.num_threads = 1;  // the order of sums, and so the result, depends on no number of threads
  options.logging_type = ceres::SILENT;
  Callback on_iteration(callback);
  options.callbacks.push_back(&on_iteration);
  ceres::Solver::Summary summary;
  const OneOpenMpThread one_thread;
  ceres::Solve(options, problem_.get(), &summary);
  if (!summary.IsSolutionUsable())
    return Status(
        ErrorCode::kDegenerate,
        "the refinement found no step that lowers its cost; refine a part of the frames, or frames with more motion");
  CopyToState();
  return BundleSummary{summary.initial_cost, summary.final_cost};
}

// Without the points the normal equations of a few views, which see the same points, are dense, and those of many
// sparse; with them they would take about twice the memory. The parts are sparse as they are: the best order to
// eliminate in is found for all variables together. Where the scene deforms every point is brought to its best after
// each step, too: coefficients against shapes is a curved valley.
void BundleProblem::SetLinearSolver(ceres::Solver::Options* options) {
  options->linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  if (input_.part != BundlePart::kAll) return;
  const auto points = std::make_shared<ceres::ParameterBlockOrdering>();
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (is_point_in_problem_[i]) points->AddElementToGroup(points_[i], 0);
  options->use_inner_iterations = rank_ > 0;
  options->inner_iteration_ordering = points;
  const auto views = static_cast<int>(std::ranges::count(is_view_in_problem_, true));
  const int without_points = views * (6 + rank_) + static_cast<int>(nodes_.size()) * 3 * rank_;
  options->linear_solver_type = without_points > kMaxDenseParameters ? ceres::SPARSE_SCHUR : ceres::DENSE_SCHUR;
  options->linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>(*points);
  std::vector<double*> blocks;
  problem_->GetParameterBlocks(&blocks);
  for (double* const block : blocks)
    if (!points->IsMember(block)) options->linear_solver_ordering->AddElementToGroup(block, 1);
}

// Blocks stand in one array: Ceres orders them by their address, and with it its sums.
void BundleProblem::CopyFromState() {
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

void BundleProblem::CopyToState() {
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

void BundleProblem::HoldFirstPose() {
  const auto found = std::ranges::find_if(views_, [&](double* view) { return problem_->HasParameterBlock(view); });
  if (found == views_.end()) return;
  double* const first = *found;
  held_view_ = first;
  if (rank_ == 0) return problem_->SetParameterBlockConstant(first);
  problem_->SetManifold(first, new ceres::SubsetManifold(6 + rank_, {0, 1, 2, 3, 4, 5}));
}

void BundleProblem::Hold(const std::vector<double*>& blocks) {
  for (double* const block : blocks)
    if (problem_->HasParameterBlock(block)) problem_->SetParameterBlockConstant(block);
}

void BundleProblem::AddReprojection() {
  for (const int count : CountViews(input_.recording, input_.used))
    losses_.push_back(std::make_unique<ceres::ScaledLoss>(
        &loss_, input_.one_measurement_per_track ? 1.0 / std::max(1, count) : 1.0, ceres::DO_NOT_TAKE_OWNERSHIP));
  for (std::size_t o = 0; o < input_.used.size(); ++o) {
    if (!input_.used[o]) continue;
    const RecordedObservation& observation = input_.recording.observations[o];
    const auto view = static_cast<std::size_t>(observation.view_idx);
    const auto point = static_cast<std::size_t>(observation.point_idx);
    // One that does not project at the start could not be evaluated.
    if (!input_.camera.Project(state_->cams_from_world[view] *
                               state_->Position(observation.point_idx, observation.view_idx)))
      continue;
    problem_->AddResidualBlock(
        NewBundleReprojectionCost(input_.camera, poses_[view], observation.pixel, input_.sigmas.noise_px, rank_),
        losses_[point].get(), views_[view], points_[point]);
    is_view_in_problem_[view] = true;
    is_point_in_problem_[point] = true;
  }
}

// (F7), in the view in the middle of a track.
void BundleProblem::AddDistances() {
  std::vector<std::vector<int>> views(points_.size());
  for (std::size_t o = 0; o < input_.used.size(); ++o)
    if (input_.used[o])
      views[static_cast<std::size_t>(input_.recording.observations[o].point_idx)].push_back(
          input_.recording.observations[o].view_idx);
  std::vector<bool> is_measured(points_.size(), false);
  for (std::size_t o = 0; o < input_.used.size(); ++o) {
    const RecordedObservation& seen = input_.recording.observations[o];
    if (!input_.used[o] || seen.view_idx != input_.recording.measured_view_idx) continue;
    const auto view = static_cast<std::size_t>(seen.view_idx);
    const auto point = static_cast<std::size_t>(seen.point_idx);
    is_measured[point] = true;
    if (!is_point_in_problem_[point]) continue;
    const double distance = (input_.recording.cams_from_world[view] * seen.position).norm();
    const double sigma = input_.sigmas.measured_log_distance * distance / input_.distance;
    measured_distances_.push_back(problem_->AddResidualBlock(NewDistanceCost(poses_[view], distance, sigma, rank_),
                                                             nullptr, views_[view], points_[point]));
  }
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (!is_point_in_problem_[i] || is_measured[i]) continue;
    const auto view = static_cast<std::size_t>(views[i][views[i].size() / 2]);
    const double distance = (input_.recording.cams_from_world[view] * input_.recording.rest_positions[i]).norm();
    problem_->AddResidualBlock(NewDistanceCost(poses_[view], distance, input_.sigmas.log_distance, rank_), nullptr,
                               views_[view], points_[i]);
  }
}

// (F3) to (F5).
void BundleProblem::AddNodes() {
  const double least = kMinDistance * input_.distance;
  const auto count = static_cast<double>(nodes_.size());
  const auto points = static_cast<double>(std::count(is_point_in_problem_.begin(), is_point_in_problem_.end(), true));
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (!is_point_in_problem_[i]) continue;
    const NodesOfPoint& around = input_.graph.nodes_of_point[i];
    std::vector<double> weights;
    std::vector<double*> blocks = {points_[i]};
    for (const NodeWeight& node : around.weights) {
      weights.push_back(node.weight);
      blocks.push_back(nodes_[static_cast<std::size_t>(node.node_idx)]);
    }
    const double scale = 1.0 / (input_.sigmas.gradient * std::max(least, around.distance));
    problem_->AddResidualBlock(NewNodePullCost(scale, weights, rank_), nullptr, blocks);
  }
  const double share = std::sqrt(points / static_cast<double>(input_.graph.edges.size()));
  for (const auto& [n, k] : input_.graph.edges) {
    const double apart =
        (state_->nodes.positions[static_cast<std::size_t>(n)] - state_->nodes.positions[static_cast<std::size_t>(k)])
            .norm();
    const double weight = share / (input_.sigmas.gradient * std::max(least, apart));
    problem_->AddResidualBlock(NewWeightedSumCost({weight, -weight}, 3 * rank_, 3 * rank_), nullptr,
                               nodes_[static_cast<std::size_t>(n)], nodes_[static_cast<std::size_t>(k)]);
  }
  for (double* const node : nodes_)
    problem_->AddResidualBlock(
        NewWeightedSumCost({std::sqrt(points / count) / (input_.sigmas.size * input_.distance)}, 3 * rank_, 3 * rank_),
        nullptr, node);
}

// (F6), by divided differences over the views in the problem.
void BundleProblem::AddCoefficients() {
  std::vector<std::size_t> views;
  for (std::size_t v = 0; v < views_.size(); ++v)
    if (is_view_in_problem_[v]) views.push_back(v);
  for (std::size_t k = 0; k < views.size(); ++k) {
    problem_->AddResidualBlock(NewWeightedSumCost({1.0}, 6 + rank_, rank_), nullptr, views_[views[k]]);
    if (k < 2) continue;
    const std::vector<double>& times = input_.recording.times;
    const double before = times[views[k - 1]] - times[views[k - 2]];
    const double after = times[views[k]] - times[views[k - 1]];
    const double unit = 0.5 * (before + after) * input_.sigmas.acceleration;
    problem_->AddResidualBlock(
        NewWeightedSumCost({1.0 / (before * unit), -1.0 / (before * unit) - 1.0 / (after * unit), 1.0 / (after * unit)},
                           6 + rank_, rank_),
        nullptr, views_[views[k - 2]], views_[views[k - 1]], views_[views[k]]);
  }
}

}  // namespace pliant
