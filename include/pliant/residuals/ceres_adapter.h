// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The kernels as Ceres cost functions, with analytic Jacobians: the only file of the module that knows Ceres.
// Parameter blocks: `increment` is PoseIncrement's (omega, tau), 6 numbers; `delta` a displacement in the world frame,
// mm. Every cost function belongs to the caller (or to the Problem that it is given to); what is handed in by pointer
// or reference must outlive it. Evaluation fails, and Ceres refuses the step, where a point leaves the camera's domain.
#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

#include "pliant/camera/camera.h"
#include "pliant/residuals/pose_increment.h"

namespace pliant {

// r(increment): a fixed point.
ceres::CostFunction* NewPoseReprojectionCost(const Camera& camera, const PoseIncrement& pose,
                                             const Eigen::Vector3d& point_in_world, const Eigen::Vector2d& pixel,
                                             double sigma_px);
// r(increment, delta): a point at position + delta.
ceres::CostFunction* NewReprojectionCost(const Camera& camera, const PoseIncrement& pose,
                                         const Eigen::Vector3d& position_in_world, const Eigen::Vector2d& pixel,
                                         double sigma_px);
// r(delta_i, delta_j).
ceres::CostFunction* NewSpatialCost(double weight, double sigma_mm);
// r(delta).
ceres::CostFunction* NewTemporalCost(double sigma_mm);
// r(delta_i, delta_j): points at position + delta.
ceres::CostFunction* NewEdgeLengthCost(const Eigen::Vector3d& position_i, const Eigen::Vector3d& position_j,
                                       double rest_length_mm, double sigma_mm);

// lambda * Huber with the threshold chi2 on the squared norm; the caller owns it.
ceres::LossFunction* NewRobustLoss(double chi2, double lambda);

}  // namespace pliant
