// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The camera's pose from known 3D points and their pixels (docs/method.md, eq. E7), and its prediction (eq. E6).
// Points in mm in the world frame, pixels with (0, 0) at the center of the first pixel.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

struct CameraPoseOptions {
  double sigma_rep_px = 1.0;          // standard deviation of a measured pixel
  double chi2_rep = 5.991;            // Huber threshold on the squared, normalized error: 95 % at 2 dof
  int max_iterations = 50;            // of Levenberg-Marquardt
  double function_tolerance = 1e-10;  // relative change of the cost at which it has converged
  int min_points = 4;                 // fewer usable points give no pose

  void List(OptionTable& table);  // group "CameraPose"
};

struct CameraPoseEstimate {
  Rigid3 cam_from_world;
  std::vector<char> inliers;  // one a point: 1 when its squared, normalized error is at most chi2_rep
  int num_inliers = 0;
  int num_used = 0;       // points that project under the initial pose; the others are left out
  double final_cost = 0;  // 0.5 * sum of rho
  int iterations = 0;
  bool converged = false;
  std::string message;  // how the solver ended
  // Of (rotation vector rad, translation mm) of a small motion applied after cam_from_world, for pixels with
  // sigma_rep_px and with each point weighted as the robust loss weights it.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

// The pose that minimizes 0.5 * sum_i rho(|u_i - project(cam_from_world * X_i)|^2 / sigma_rep^2), rho = Huber.
// Fails with kMismatch for counts that differ, kInvalidArgument for numbers that are not finite, kInsufficient for
// fewer than min_points points that project under the initial pose, kDegenerate when they do not determine a pose.
// Running out of iterations is no failure: see `converged`.
Result<CameraPoseEstimate> EstimateCameraPose(const Camera& camera, std::span<const Eigen::Vector3d> points_in_world,
                                              std::span<const Eigen::Vector2d> pixels,
                                              const Rigid3& initial_cam_from_world, const CameraPoseOptions& options);

// Constant velocity: the camera repeats the motion that it made between the last two frames (eq. E6).
inline Rigid3 PredictCameraPose(const Rigid3& before_last_cam_from_world, const Rigid3& last_cam_from_world) {
  return last_cam_from_world * before_last_cam_from_world.Inverse() * last_cam_from_world;
}

}  // namespace pliant
