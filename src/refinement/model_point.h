// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// (F1) A point of the model in a camera's frame, by the numbers of its view (pose increment, R temporal coefficients)
// and its own (rest position, R basis shapes).
#pragma once

#include <Eigen/Core>

#include "pliant/residuals/pose_increment.h"

namespace pliant {

class ModelPoint {
 public:
  // All must outlive it. With a rank of 0 it is the point at rest.
  ModelPoint(const PoseIncrement& pose, const double* view, const double* point, int rank)
      : rank_(rank), coefficients_(view + 6), shapes_(point + 3) {
    Eigen::Vector3d position = Eigen::Map<const Eigen::Vector3d>(point);
    for (int r = 0; r < rank; ++r) position += coefficients_[r] * Shape(r);
    posed_ = pose.Posed(view, position);
    cam_from_world_ = RotationExp(posed_.omega_rad).toRotationMatrix() * pose.reference_rotation();
  }

  const Eigen::Vector3d& in_cam() const { return posed_.in_cam; }

  // From derivatives of something by that position those by the numbers of the view, kRows x (6 + R), and of the point,
  // kRows x (3 + 3 R), row by row.
  template <int kRows>
  void ByView(const Eigen::Matrix<double, kRows, 3>& by_cam_point, double* by_view) const {
    Jacobian<kRows> jacobian(by_view, kRows, 6 + rank_);
    jacobian.template leftCols<6>() = by_cam_point * posed_.ByIncrement();
    const Eigen::Matrix<double, kRows, 3> by_position = by_cam_point * cam_from_world_;
    for (int r = 0; r < rank_; ++r) jacobian.col(6 + r) = by_position * Shape(r);
  }
  template <int kRows>
  void ByPoint(const Eigen::Matrix<double, kRows, 3>& by_cam_point, double* by_point) const {
    Jacobian<kRows> jacobian(by_point, kRows, 3 + 3 * rank_);
    const Eigen::Matrix<double, kRows, 3> by_position = by_cam_point * cam_from_world_;
    jacobian.template leftCols<3>() = by_position;
    for (int r = 0; r < rank_; ++r) jacobian.template middleCols<3>(3 + 3 * r) = coefficients_[r] * by_position;
  }

 private:
  template <int kRows>
  using Jacobian = Eigen::Map<Eigen::Matrix<double, kRows, Eigen::Dynamic, Eigen::RowMajor>>;

  Eigen::Map<const Eigen::Vector3d> Shape(int r) const { return Eigen::Map<const Eigen::Vector3d>(shapes_ + 3 * r); }

  int rank_;
  const double* coefficients_;
  const double* shapes_;
  PosedPoint posed_;
  Eigen::Matrix3d cam_from_world_;
};

}  // namespace pliant
