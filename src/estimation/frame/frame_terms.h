// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The joint problem as its solvers see it: checked, without the points that do not project, points numbered through.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "pliant/estimation/frame/frame_problem.h"
#include "pliant/residuals/pose_increment.h"

namespace pliant {

struct FrameTerms {
  const Camera* camera = nullptr;
  FrameProblemOptions options;
  std::vector<int> input_idx;              // of each point here, its position in the input; ascending
  std::vector<Eigen::Vector3d> positions;  // X_i(t-1), world, mm
  std::vector<Eigen::Vector2d> pixels;     // u_i
  std::vector<GraphEdge> edges;            // between points here, sorted by (i, j)
  PoseIncrement pose;                      // around the initial pose, pivot at the points' mean
  FramePose pose_is = FramePose::kEstimated;

  int num_points() const { return static_cast<int>(positions.size()); }
};

// What a solver hands back.
struct FrameEstimate {
  Rigid3 cam_from_world;
  std::vector<Eigen::Vector3d> positions;  // X_i + delta_i, one a point of FrameTerms
  int iterations = 0;
  bool converged = false;
  std::string message;
};

// Levenberg-Marquardt on one residual block a term, sparse Cholesky; kDegenerate when Ceres has no usable solution.
Result<FrameEstimate> SolveFrameByLevenbergMarquardt(const FrameTerms& terms);
// L-BFGS in preconditioned variables (frame_preconditioner.h); kDegenerate as above.
Result<FrameEstimate> SolveFrameByLbfgs(const FrameTerms& terms);

}  // namespace pliant
