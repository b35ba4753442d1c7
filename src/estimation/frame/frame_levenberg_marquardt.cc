// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The joint problem with one residual block a term, as published: variables are the pose and every delta_i.
#include <array>
#include <memory>

#include <ceres/ceres.h>

#include "estimation/frame/frame_terms.h"
#include "pliant/residuals/ceres_adapter.h"

namespace pliant {
namespace {

using Deltas = std::vector<Eigen::Vector3d>;

// The loss of each term; an edge that stands for both directions counts twice.
struct Losses {
  explicit Losses(const FrameProblemOptions& options)
      : rep(NewRobustLoss(options.chi2_rep, 1.0)),
        tmp(NewRobustLoss(options.chi2_tmp, options.lambda_tmp)),
        spa{std::unique_ptr<ceres::LossFunction>(NewRobustLoss(options.chi2_spa, options.lambda_spa)),
            std::unique_ptr<ceres::LossFunction>(NewRobustLoss(options.chi2_spa, 2.0 * options.lambda_spa))},
        len{std::unique_ptr<ceres::LossFunction>(NewRobustLoss(options.chi2_len, options.lambda_len)),
            std::unique_ptr<ceres::LossFunction>(NewRobustLoss(options.chi2_len, 2.0 * options.lambda_len))} {}

  std::unique_ptr<ceres::LossFunction> rep;
  std::unique_ptr<ceres::LossFunction> tmp;
  std::array<std::unique_ptr<ceres::LossFunction>, 2> spa;  // by multiplicity - 1
  std::array<std::unique_ptr<ceres::LossFunction>, 2> len;
};

void AddTerms(const FrameTerms& terms, const Losses& losses, Vector6d* increment, Deltas* deltas,
              ceres::Problem* problem) {
  const FrameProblemOptions& options = terms.options;
  for (int i = 0; i < terms.num_points(); ++i) {
    double* delta = (*deltas)[i].data();
    problem->AddResidualBlock(
        NewReprojectionCost(*terms.camera, terms.pose, terms.positions[i], terms.pixels[i], options.sigma_rep_px),
        losses.rep.get(), increment->data(), delta);
    problem->AddResidualBlock(NewTemporalCost(options.sigma_tmp_mm), losses.tmp.get(), delta);
  }
  for (const GraphEdge& edge : terms.edges) {
    double* delta_i = (*deltas)[edge.i].data();
    double* delta_j = (*deltas)[edge.j].data();
    problem->AddResidualBlock(NewSpatialCost(edge.weight, options.sigma_spa_mm),
                              losses.spa[edge.multiplicity - 1].get(), delta_i, delta_j);
    if (options.edge_length == Switch::kOff) continue;
    problem->AddResidualBlock(
        NewEdgeLengthCost(terms.positions[edge.i], terms.positions[edge.j], edge.rest_length_mm, options.sigma_len_mm),
        losses.len[edge.multiplicity - 1].get(), delta_i, delta_j);
  }
}

}  // namespace

Result<FrameEstimate> SolveFrameByLevenbergMarquardt(const FrameTerms& terms) {
  Vector6d increment = Vector6d::Zero();
  Deltas deltas(terms.positions.size(), Eigen::Vector3d::Zero());
  const Losses losses(terms.options);
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.disable_all_safety_checks = true;  // thousands of blocks, all of the right size and of their own data
  ceres::Problem problem(problem_options);
  AddTerms(terms, losses, &increment, &deltas, &problem);
  if (terms.pose_is == FramePose::kHeld) problem.SetParameterBlockConstant(increment.data());

  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = terms.options.max_iterations;
  options.function_tolerance = terms.options.function_tolerance;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable() || !increment.allFinite())
    return {ErrorCode::kDegenerate, "the joint problem of pose and deformation has no solution: " + summary.message};

  FrameEstimate estimate;
  estimate.cam_from_world = terms.pose.Pose(increment);
  estimate.positions = terms.positions;
  for (int i = 0; i < terms.num_points(); ++i) estimate.positions[i] += deltas[i];
  estimate.iterations = static_cast<int>(summary.iterations.size()) - 1;
  estimate.converged = summary.termination_type == ceres::CONVERGENCE;
  estimate.message = summary.message;
  return estimate;
}

}  // namespace pliant
