// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The terms of a deforming window as Ceres cost functions, with analytic derivatives (docs/method.md, eq. W2 to W7).
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <ceres/cost_function.h>
#include <ceres/sized_cost_function.h>

#include "estimation/ceres_support.h"
#include "estimation/ray_residuals.h"

namespace pliant {

// A point by its chart: X = exp(d) (f + u b0 + v b1), f its ray in the reference and b0, b1 across it; parameters
// (u, v, d). Far points, whose depth is hardly known, make no trouble in d, and the gauge and the light are linear in
// it.
struct PointChart {
  Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();
  RayBasis basis = RayBasis::Zero();

  static PointChart Across(const Eigen::Vector3d& ray) { return {ray, BasisAcross(ray)}; }

  Eigen::Vector3d Parameters(const Eigen::Vector3d& point) const {
    const double along = point.dot(ray);
    const Eigen::Vector2d across = basis * point / along;
    return {across.x(), across.y(), std::log(along)};
  }
  Eigen::Vector3d Point(const Eigen::Vector3d& parameters) const {
    return std::exp(parameters.z()) * (ray + basis.transpose() * parameters.head<2>());
  }
  // d X / d (u, v, d).
  Eigen::Matrix3d Derivative(const Eigen::Vector3d& parameters) const {
    Eigen::Matrix3d by;
    by.leftCols<2>() = std::exp(parameters.z()) * basis.transpose();
    by.col(2) = Point(parameters);
    return by;
  }
};

// (W2) Blocks: rotation (x, y, z, w), translation, point, and with R > 0 courses (R), modes (3 R). Unit: px.
class DeformingDirectionCost final : public ceres::CostFunction {
 public:
  DeformingDirectionCost(const PointChart& chart, const Eigen::Vector3d& ray, double focal_px, int rank)
      : chart_(chart), ray_(ray), basis_(BasisAcross(ray)), focal_px_(focal_px), rank_(rank) {
    set_num_residuals(2);
    *mutable_parameter_block_sizes() = {4, 3, 3};
    if (rank > 0) {
      mutable_parameter_block_sizes()->push_back(rank);
      mutable_parameter_block_sizes()->push_back(3 * rank);
    }
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Quaterniond rotation = ReadQuaternion(parameters[0]);
    const Eigen::Map<const Eigen::Vector3d> translation(parameters[1]);
    const Eigen::Map<const Eigen::Vector3d> point(parameters[2]);
    Eigen::Vector3d x = chart_.Point(point);
    if (rank_ > 0) x += Modes(parameters) * Courses(parameters);
    DirectionResidual residual;
    if (!EvaluateDirection(rotation, translation, x, ray_, basis_, &residual)) return false;
    Eigen::Map<Eigen::Vector2d>{residuals} = focal_px_ * residual.value;
    if (jacobians == nullptr) return true;

    const Eigen::Matrix<double, 2, 3> by_x = focal_px_ * residual.by_point;
    if (jacobians[0] != nullptr)
      Eigen::Map<Eigen::Matrix<double, 2, 4, Eigen::RowMajor>>{jacobians[0]} = focal_px_ * residual.by_rotation;
    if (jacobians[1] != nullptr)
      Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>>{jacobians[1]} = focal_px_ * residual.by_translation;
    if (jacobians[2] != nullptr)
      Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>>{jacobians[2]} = by_x * chart_.Derivative(point);
    if (rank_ == 0) return true;
    if (jacobians[3] != nullptr) RowMajor2X(jacobians[3], 2, rank_) = by_x * Modes(parameters);
    if (jacobians[4] != nullptr) {
      RowMajor2X by_modes(jacobians[4], 2, 3 * rank_);
      for (int r = 0; r < rank_; ++r) by_modes.middleCols<3>(3 * r) = Courses(parameters)[r] * by_x;
    }
    return true;
  }

 private:
  using RowMajor2X = Eigen::Map<Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor>>;
  Eigen::Map<const Eigen::VectorXd> Courses(double const* const* parameters) const { return {parameters[3], rank_}; }
  Eigen::Map<const Eigen::Matrix3Xd> Modes(double const* const* parameters) const { return {parameters[4], 3, rank_}; }

  PointChart chart_;
  Eigen::Vector3d ray_;
  RayBasis basis_;
  double focal_px_;
  int rank_;
};

// r = sum_k a_k x_k over blocks of equal size: the linear terms (W3), (W4), (W5).
class LinearCost final : public ceres::CostFunction {
 public:
  LinearCost(std::vector<double> factors, int size) : factors_(std::move(factors)), size_(size) {
    set_num_residuals(size);
    mutable_parameter_block_sizes()->assign(factors_.size(), size);
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    Eigen::Map<Eigen::VectorXd> value(residuals, size_);
    value.setZero();
    for (std::size_t k = 0; k < factors_.size(); ++k)
      value += factors_[k] * Eigen::Map<const Eigen::VectorXd>(parameters[k], size_);
    if (jacobians == nullptr) return true;
    for (std::size_t k = 0; k < factors_.size(); ++k)
      if (jacobians[k] != nullptr)
        Eigen::Map<Eigen::MatrixXd>(jacobians[k], size_, size_) = factors_[k] * Eigen::MatrixXd::Identity(size_, size_);
    return true;
  }

 private:
  std::vector<double> factors_;
  int size_;
};

// (W7) r = w (mean d - mean d at the start) over the points of the gauge. Blocks: points.
class ScaleCost final : public ceres::CostFunction {
 public:
  ScaleCost(int num_points, double mean, double weight) : mean_(mean), weight_(weight) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->assign(static_cast<std::size_t>(num_points), 3);
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const std::size_t count = parameter_block_sizes().size();
    const double each = weight_ / static_cast<double>(count);
    residuals[0] = -weight_ * mean_;
    for (std::size_t k = 0; k < count; ++k) residuals[0] += each * parameters[k][2];
    if (jacobians == nullptr) return true;
    for (std::size_t k = 0; k < count; ++k)
      if (jacobians[k] != nullptr) Eigen::Map<Eigen::RowVector3d>{jacobians[k]} << 0.0, 0.0, each;
    return true;
  }

 private:
  double mean_;
  double weight_;
};

// (W6) r = (d - log distance by light - offset) / sigma. Blocks: point, offset (1).
class LightCost final : public ceres::SizedCostFunction<1, 3, 1> {
 public:
  LightCost(double log_distance, double sigma) : log_distance_(log_distance), sigma_(sigma) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    residuals[0] = (parameters[0][2] - log_distance_ - parameters[1][0]) / sigma_;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) Eigen::Map<Eigen::RowVector3d>{jacobians[0]} << 0.0, 0.0, 1.0 / sigma_;
    if (jacobians[1] != nullptr) jacobians[1][0] = -1.0 / sigma_;
    return true;
  }

 private:
  double log_distance_;
  double sigma_;
};

}  // namespace pliant
