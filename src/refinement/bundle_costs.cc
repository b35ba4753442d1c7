// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "refinement/bundle_costs.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pliant/residuals/reprojection.h"
#include "refinement/model_point.h"

namespace pliant {
namespace {

using ConstVector = Eigen::Map<const Eigen::VectorXd>;
using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Jacobian = Eigen::Map<RowMajorMatrix>;

template <class Model>
class BundleReprojectionCost final : public ceres::CostFunction {
 public:
  BundleReprojectionCost(const Model& model, const PoseIncrement& pose, const Eigen::Vector2d& pixel, double sigma_px,
                         int rank)
      : kernel_(model, sigma_px), pose_(&pose), pixel_(pixel), rank_(rank) {
    set_num_residuals(2);
    *mutable_parameter_block_sizes() = {6 + rank, 3 + 3 * rank};
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const ModelPoint point(*pose_, parameters[0], parameters[1], rank_);
    Eigen::Vector2d residual;
    ReprojectionJacobian by_cam_point;
    if (!kernel_.ResidualAndJacobian(pixel_, point.in_cam(), &residual, &by_cam_point)) return false;
    Eigen::Map<Eigen::Vector2d>{residuals} = residual;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) point.ByView<2>(by_cam_point, jacobians[0]);
    if (jacobians[1] != nullptr) point.ByPoint<2>(by_cam_point, jacobians[1]);
    return true;
  }

 private:
  ReprojectionKernel<Model> kernel_;
  const PoseIncrement* pose_;
  Eigen::Vector2d pixel_;
  int rank_;
};

class NodePullCost final : public ceres::CostFunction {
 public:
  NodePullCost(double scale, const std::vector<double>& weights, int rank)
      : scale_(scale), weights_(weights), size_(3 * rank) {
    set_num_residuals(size_);
    mutable_parameter_block_sizes()->assign(weights.size() + 1, size_);
    mutable_parameter_block_sizes()->front() = 3 + size_;
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    Eigen::Map<Eigen::VectorXd> residual(residuals, size_);
    residual = scale_ * ConstVector(parameters[0] + 3, size_);
    for (std::size_t n = 0; n < weights_.size(); ++n)
      residual -= scale_ * weights_[n] * ConstVector(parameters[n + 1], size_);
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) {
      Jacobian by_point(jacobians[0], size_, 3 + size_);
      by_point.setZero();
      by_point.rightCols(size_).diagonal().setConstant(scale_);
    }
    for (std::size_t n = 0; n < weights_.size(); ++n)
      if (jacobians[n + 1] != nullptr)
        Jacobian{jacobians[n + 1], size_, size_} = -scale_ * weights_[n] * Eigen::MatrixXd::Identity(size_, size_);
    return true;
  }

 private:
  double scale_;
  std::vector<double> weights_;
  int size_;
};

class WeightedSumCost final : public ceres::CostFunction {
 public:
  WeightedSumCost(const std::vector<double>& weights, int block_size, int size)
      : weights_(weights), before_(block_size - size), size_(size) {
    set_num_residuals(size);
    mutable_parameter_block_sizes()->assign(weights.size(), block_size);
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    Eigen::Map<Eigen::VectorXd> residual(residuals, size_);
    residual.setZero();
    for (std::size_t k = 0; k < weights_.size(); ++k)
      residual += weights_[k] * ConstVector(parameters[k] + before_, size_);
    for (std::size_t k = 0; k < weights_.size() && jacobians != nullptr; ++k) {
      if (jacobians[k] == nullptr) continue;
      Jacobian by_block(jacobians[k], size_, before_ + size_);
      by_block.setZero();
      by_block.rightCols(size_).diagonal().setConstant(weights_[k]);
    }
    return true;
  }

 private:
  std::vector<double> weights_;
  int before_;
  int size_;
};

class DistanceCost final : public ceres::CostFunction {
 public:
  DistanceCost(const PoseIncrement& pose, double distance, double sigma, int rank)
      : pose_(&pose), distance_(distance), scale_(1.0 / sigma) {
    set_num_residuals(1);
    *mutable_parameter_block_sizes() = {6 + rank, 3 + 3 * rank};
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const ModelPoint at_rest(*pose_, parameters[0], parameters[1], 0);
    const double squared = at_rest.in_cam().squaredNorm();
    if (!(squared > 0.0)) return false;
    residuals[0] = scale_ * std::log(std::sqrt(squared) / distance_);
    if (jacobians == nullptr) return true;
    const Eigen::RowVector3d by_cam_point = scale_ / squared * at_rest.in_cam().transpose();
    for (int k = 0; k < 2; ++k)
      if (jacobians[k] != nullptr) std::fill_n(jacobians[k], parameter_block_sizes()[static_cast<std::size_t>(k)], 0.0);
    if (jacobians[0] != nullptr) at_rest.ByView<1>(by_cam_point, jacobians[0]);
    if (jacobians[1] != nullptr) at_rest.ByPoint<1>(by_cam_point, jacobians[1]);
    return true;
  }

 private:
  const PoseIncrement* pose_;
  double distance_;
  double scale_;
};

}  // namespace

ceres::CostFunction* NewBundleReprojectionCost(const Camera& camera, const PoseIncrement& pose,
                                               const Eigen::Vector2d& pixel, double sigma_px, int rank) {
  return camera.Visit([&](const auto& model) -> ceres::CostFunction* {
    return new BundleReprojectionCost(model, pose, pixel, sigma_px, rank);
  });
}

ceres::CostFunction* NewNodePullCost(double scale, const std::vector<double>& weights, int rank) {
  return new NodePullCost(scale, weights, rank);
}

ceres::CostFunction* NewWeightedSumCost(const std::vector<double>& weights, int block_size, int size) {
  return new WeightedSumCost(weights, block_size, size);
}

ceres::CostFunction* NewDistanceCost(const PoseIncrement& pose, double distance, double sigma, int rank) {
  return new DistanceCost(pose, distance, sigma, rank);
}

}  // namespace pliant
