// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The solvers of the joint problem.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "estimation/frame/frame_data.h"
#include "estimation/frame/frame_terms.h"
#include "pliant/base/status.h"

namespace pliant {

// What a solver hands back.
struct FrameEstimate {
  Rigid3 cam_from_world;
  std::vector<Eigen::Vector3d> positions;  // X_i + delta_i, one a point of FrameData
  int iterations = 0;
  bool converged = false;
  std::string message;
};

// Levenberg-Marquardt on one residual block a term, sparse Cholesky; kDegenerate when Ceres has no usable solution.
Result<FrameEstimate> SolveFrameByLevenbergMarquardt(const FrameData& data, const FrameTerms& terms);
// L-BFGS in preconditioned variables (frame_preconditioner.h); kDegenerate as above.
Result<FrameEstimate> SolveFrameByLbfgs(const FrameData& data, const FrameTerms& terms);

}  // namespace pliant
