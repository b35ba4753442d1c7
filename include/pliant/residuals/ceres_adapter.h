// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The kernels as Ceres cost functions, with analytic Jacobians: the only file of the module that knows Ceres.
// Parameter blocks: `increment` is PoseIncrement's (omega, tau), 6 numbers; `delta` a displacement in the world frame,
// mm. Every cost function belongs to the caller (or to the Problem that it is given to); what is handed in by pointer
// or reference must outlive it. Evaluation fails, and Ceres refuses the step, where a point leaves the camera's domain.
#pragma once

#include <Eigen/Core>
#include <ceres/loss_function.h>
#include <ceres/sized_cost_function.h>

#include "pliant/camera/camera.h"
#include "pliant/residuals/pose_increment.h"

namespace pliant {

// r(delta) of a kernel whose Jacobian is scale() * I: TemporalKernel.
template <class Kernel>
class DisplacementCost final : public ceres::SizedCostFunction<3, 3> {
 public:
  explicit DisplacementCost(const Kernel& kernel) : kernel_(kernel) {}

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    Eigen::Map<Eigen::Vector3d>{residuals} =
        kernel_.template Residual<double>(Eigen::Map<const Eigen::Vector3d>(parameters[0]));
    if (jacobians != nullptr && jacobians[0] != nullptr)
      Eigen::Map<Eigen::Matrix3d>{jacobians[0]} = Eigen::Matrix3d::Identity() * kernel_.scale();
    return true;
  }

 private:
  Kernel kernel_;
};

// r(delta_i, delta_j) of a kernel whose Jacobians are scale() * I and -scale() * I: SpatialKernel.
template <class Kernel>
class DifferenceCost final : public ceres::SizedCostFunction<3, 3, 3> {
 public:
  explicit DifferenceCost(const Kernel& kernel) : kernel_(kernel) {}

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    Eigen::Map<Eigen::Vector3d>{residuals} = kernel_.template Residual<double>(
        Eigen::Map<const Eigen::Vector3d>(parameters[0]), Eigen::Map<const Eigen::Vector3d>(parameters[1]));
    for (int k = 0; k < 2 && jacobians != nullptr; ++k) {
      if (jacobians[k] == nullptr) continue;
      Eigen::Map<Eigen::Matrix3d>{jacobians[k]} =
          Eigen::Matrix3d::Identity() * (k == 0 ? kernel_.scale() : -kernel_.scale());
    }
    return true;
  }

 private:
  Kernel kernel_;
};

// r(increment): a fixed point.
ceres::CostFunction* NewPoseReprojectionCost(const Camera& camera, const PoseIncrement& pose,
                                             const Eigen::Vector3d& point_in_world, const Eigen::Vector2d& pixel,
                                             double sigma_px);
// r(increment, delta): a point at position + delta.
ceres::CostFunction* NewReprojectionCost(const Camera& camera, const PoseIncrement& pose,
                                         const Eigen::Vector3d& position_in_world, const Eigen::Vector2d& pixel,
                                         double sigma_px);
// r(delta_i, delta_j): points at position + delta.
ceres::CostFunction* NewEdgeLengthCost(const Eigen::Vector3d& position_i, const Eigen::Vector3d& position_j,
                                       double rest_length_mm, double sigma_mm);

// lambda * Huber with the threshold chi2 on the squared norm; the caller owns it.
ceres::LossFunction* NewRobustLoss(double chi2, double lambda);

}  // namespace pliant
