// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The reprojection term of one point (docs/method.md, eq. E1).
//   r = (project(x) - u) / sigma_rep        2 numbers, in standard deviations
// x the point in the camera frame (mm), u the measured pixel, sigma_rep in px.
// Jacobian: dr / dx = (d project / dx) / sigma_rep, which vanishes along x; the pose's part follows by the chain rule
// from PoseIncrement. False where the camera does not see the point (behind a pinhole): the step that led there is
// refused, never counted as zero.
#pragma once

#include <Eigen/Core>

namespace pliant {

using ReprojectionJacobian = Eigen::Matrix<double, 2, 3, Eigen::RowMajor>;

// Model: one of camera/models.h.
template <class Model>
class ReprojectionKernel {
 public:
  ReprojectionKernel(const Model& model, double sigma_px) : model_(&model), scale_(1.0 / sigma_px) {}

  template <class T>
  bool Residual(const Eigen::Vector2d& pixel, const Eigen::Matrix<T, 3, 1>& point_in_cam,
                Eigen::Matrix<T, 2, 1>* residual) const {
    if (!model_->Project(point_in_cam.data(), residual->data())) return false;
    (*residual)(0) = ((*residual)(0) - pixel.x()) * scale_;
    (*residual)(1) = ((*residual)(1) - pixel.y()) * scale_;
    return true;
  }

  bool ResidualAndJacobian(const Eigen::Vector2d& pixel, const Eigen::Vector3d& point_in_cam, Eigen::Vector2d* residual,
                           ReprojectionJacobian* jacobian) const {
    if (!model_->ProjectWithJacobian(point_in_cam.data(), residual->data(), jacobian->data())) return false;
    *residual = (*residual - pixel) * scale_;
    *jacobian *= scale_;
    return true;
  }

 private:
  const Model* model_;
  double scale_;
};

}  // namespace pliant
