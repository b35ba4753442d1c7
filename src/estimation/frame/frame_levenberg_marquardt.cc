// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The joint problem with one residual block a term, as published: variables are the pose and every delta_i.
#include <ceres/ceres.h>

#include "estimation/frame/frame_solvers.h"

namespace pliant {

Result<FrameEstimate> SolveFrameByLevenbergMarquardt(const FrameData& data, const FrameTerms& terms) {
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.disable_all_safety_checks = true;  // thousands of blocks, all of the right size and of their own data
  ceres::Problem problem(problem_options);
  FrameBlocks blocks{&problem, Vector6d::Zero(), {data.positions.size(), Eigen::Vector3d::Zero()}};
  for (int i = 0; i < data.num_points(); ++i)
    for (const auto& term : terms) term->AddPointBlock(i, &blocks);
  for (const GraphEdge& edge : data.edges)
    for (const auto& term : terms) term->AddEdgeBlock(edge, &blocks);
  for (const auto& term : terms) term->AddFrameBlock(&blocks);
  if (data.pose_is == FramePose::kHeld) problem.SetParameterBlockConstant(blocks.increment.data());

  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = data.options.max_iterations;
  options.function_tolerance = data.options.function_tolerance;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable() || !blocks.increment.allFinite())
    return {ErrorCode::kDegenerate, "the joint problem of pose and deformation has no solution"};

  FrameEstimate estimate;
  estimate.cam_from_world = data.pose.Pose(blocks.increment);
  estimate.positions = data.positions;
  for (int i = 0; i < data.num_points(); ++i) estimate.positions[i] += blocks.deltas[i];
  estimate.iterations = static_cast<int>(summary.iterations.size()) - 1;
  estimate.converged = summary.termination_type == ceres::CONVERGENCE;
  estimate.message = summary.message;
  return estimate;
}

}  // namespace pliant
