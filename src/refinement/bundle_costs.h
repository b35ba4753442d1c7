// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The terms of a refinement as Ceres cost functions, with analytic Jacobians (docs/method.md, eq. F2 to F6). Parameter
// blocks: a view (its PoseIncrement and its R temporal coefficients, 6 + R numbers), a point (its rest position and its
// R basis shapes, 3 + 3 R), the basis shapes of a node (3 R). What is handed in by reference must outlive the cost;
// Ceres owns it. A rank of 0 is a rigid scene: then there are no coefficients and no nodes.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <ceres/cost_function.h>

#include "pliant/camera/camera.h"
#include "pliant/residuals/pose_increment.h"

namespace pliant {

// (F2) r(view, point) = (project(T_v (X + sum_r c_r(v) m_r)) - u) / sigma. Evaluation fails, and
// Ceres refuses the step, where the point leaves the camera's domain.
ceres::CostFunction* NewBundleReprojectionCost(const Camera& camera, const PoseIncrement& pose,
                                               const Eigen::Vector2d& pixel, double sigma_px, int rank);

// (F3) r(point, shapes ...) = scale (m - sum_n w_n M_n), w_n = `weights`, for the nodes around a point.
ceres::CostFunction* NewNodePullCost(double scale, const std::vector<double>& weights, int rank);

// (F4 to F6) r(blocks ...) = sum_k w_k x_k, w_k = `weights`, x_k the last `size` numbers of blocks of `block_size`:
// differences of nodes, sizes, second differences in time.
ceres::CostFunction* NewWeightedSumCost(const std::vector<double>& weights, int block_size, int size);

// (F7) r(view, point) = log(|T_v X| / d) / sigma: X at rest, d its distance at the start.
ceres::CostFunction* NewDistanceCost(const PoseIncrement& pose, double distance, double sigma, int rank);

}  // namespace pliant
