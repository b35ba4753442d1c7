// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/residuals/ceres_adapter.h"

#include <cmath>

#include "pliant/residuals/edge_length.h"
#include "pliant/residuals/reprojection.h"

namespace pliant {
namespace {

using ConstVector3 = Eigen::Map<const Eigen::Vector3d>;
template <int kRows, int kCols>
using RowMajor = Eigen::Map<Eigen::Matrix<double, kRows, kCols, Eigen::RowMajor>>;

template <class Model>
class PoseReprojectionCost final : public ceres::SizedCostFunction<2, 6> {
 public:
  PoseReprojectionCost(const Model& model, const PoseIncrement& pose, const Eigen::Vector3d& point,
                       const Eigen::Vector2d& pixel, double sigma_px)
      : kernel_(model, sigma_px), pose_(&pose), point_(point), pixel_(pixel) {}

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const PosedPoint posed = pose_->Posed(parameters[0], point_);
    Eigen::Vector2d residual;
    ReprojectionJacobian jacobian;
    if (!kernel_.ResidualAndJacobian(pixel_, posed.in_cam, &residual, &jacobian)) return false;
    Eigen::Map<Eigen::Vector2d>{residuals} = residual;
    if (jacobians != nullptr && jacobians[0] != nullptr)
      RowMajor<2, 6>(jacobians[0]).noalias() = jacobian * posed.ByIncrement();
    return true;
  }

 private:
  ReprojectionKernel<Model> kernel_;
  const PoseIncrement* pose_;
  Eigen::Vector3d point_;
  Eigen::Vector2d pixel_;
};

template <class Model>
class ReprojectionCost final : public ceres::SizedCostFunction<2, 6, 3> {
 public:
  ReprojectionCost(const Model& model, const PoseIncrement& pose, const Eigen::Vector3d& position,
                   const Eigen::Vector2d& pixel, double sigma_px)
      : kernel_(model, sigma_px), pose_(&pose), position_(position), pixel_(pixel) {}

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const PosedPoint posed = pose_->Posed(parameters[0], position_ + ConstVector3(parameters[1]));
    Eigen::Vector2d residual;
    ReprojectionJacobian jacobian;
    if (!kernel_.ResidualAndJacobian(pixel_, posed.in_cam, &residual, &jacobian)) return false;
    Eigen::Map<Eigen::Vector2d>{residuals} = residual;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) RowMajor<2, 6>(jacobians[0]).noalias() = jacobian * posed.ByIncrement();
    if (jacobians[1] != nullptr) {
      RowMajor<2, 3> by_delta(jacobians[1]);
      for (int c = 0; c < 3; ++c)
        by_delta.col(c) =
            jacobian * RotateByExp<double>(ConstVector3(parameters[0]), pose_->reference_rotation().col(c));
    }
    return true;
  }

 private:
  ReprojectionKernel<Model> kernel_;
  const PoseIncrement* pose_;
  Eigen::Vector3d position_;
  Eigen::Vector2d pixel_;
};

class EdgeLengthCost final : public ceres::SizedCostFunction<1, 3, 3> {
 public:
  EdgeLengthCost(const EdgeLengthKernel& kernel, const Eigen::Vector3d& position_i, const Eigen::Vector3d& position_j)
      : kernel_(kernel), position_i_(position_i), position_j_(position_j) {}

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Vector3d p_i = position_i_ + ConstVector3(parameters[0]);
    const Eigen::Vector3d p_j = position_j_ + ConstVector3(parameters[1]);
    residuals[0] = kernel_.Residual<double>(p_i, p_j);
    if (jacobians == nullptr) return true;
    const Eigen::Vector3d by_i = kernel_.Jacobian(p_i, p_j);
    if (jacobians[0] != nullptr) Eigen::Map<Eigen::Vector3d>{jacobians[0]} = by_i;
    if (jacobians[1] != nullptr) Eigen::Map<Eigen::Vector3d>{jacobians[1]} = -by_i;
    return true;
  }

 private:
  EdgeLengthKernel kernel_;
  Eigen::Vector3d position_i_;
  Eigen::Vector3d position_j_;
};

}  // namespace

ceres::CostFunction* NewPoseReprojectionCost(const Camera& camera, const PoseIncrement& pose,
                                             const Eigen::Vector3d& point_in_world, const Eigen::Vector2d& pixel,
                                             double sigma_px) {
  return camera.Visit([&]<class Model>(const Model& model) -> ceres::CostFunction* {
    return new PoseReprojectionCost<Model>(model, pose, point_in_world, pixel, sigma_px);
  });
}

ceres::CostFunction* NewReprojectionCost(const Camera& camera, const PoseIncrement& pose,
                                         const Eigen::Vector3d& position_in_world, const Eigen::Vector2d& pixel,
                                         double sigma_px) {
  return camera.Visit([&]<class Model>(const Model& model) -> ceres::CostFunction* {
    return new ReprojectionCost<Model>(model, pose, position_in_world, pixel, sigma_px);
  });
}

ceres::CostFunction* NewEdgeLengthCost(const Eigen::Vector3d& position_i, const Eigen::Vector3d& position_j,
                                       double rest_length_mm, double sigma_mm) {
  return new EdgeLengthCost(EdgeLengthKernel(rest_length_mm, sigma_mm), position_i, position_j);
}

ceres::LossFunction* NewRobustLoss(double chi2, double lambda) {
  return new ceres::ScaledLoss(new ceres::HuberLoss(std::sqrt(chi2)), lambda, ceres::TAKE_OWNERSHIP);
}

}  // namespace pliant
