// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The joint problem as its terms and solvers see it: checked, without the points that do not project, points numbered
// through.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pliant/estimation/frame/frame_problem.h"
#include "pliant/residuals/pose_increment.h"

namespace pliant {

struct FrameData {
  const Camera* camera = nullptr;
  FrameProblemOptions options;
  std::vector<int> input_idx;              // of each point here, its index in the input; ascending
  std::vector<Eigen::Vector3d> positions;  // X_i(t-1), world, mm
  std::vector<Eigen::Vector2d> pixels;     // u_i
  std::vector<GraphEdge> edges;            // between points here, sorted by (i, j)
  PoseIncrement pose;                      // around the initial pose, pivot at the points' mean
  FramePose pose_is = FramePose::kEstimated;
  const FrameCost* cost = nullptr;  // the program's own term, or none
  int frame_idx = 0;
  std::vector<PointId> ids;  // of the points here, or none

  int num_points() const { return static_cast<int>(positions.size()); }
};

}  // namespace pliant
