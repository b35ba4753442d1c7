// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/pose/camera_pose.h"

#include <memory>
#include <string>

#include <Eigen/Cholesky>
#include <ceres/ceres.h>

#include "pliant/geometry/decompositions.h"
#include "pliant/residuals/ceres_adapter.h"
#include "pliant/residuals/huber.h"
#include "pliant/residuals/reprojection.h"

namespace pliant {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

// Reciprocal condition of the normal equations, scaled to a unit diagonal, below which a direction of the pose is free.
// Points on a line leave rounding there, about 1e-15.
constexpr double kFreeDirection = 1e-12;

Status Check(std::span<const Eigen::Vector3d> points, std::span<const Eigen::Vector2d> pixels, const Rigid3& pose) {
  if (points.size() != pixels.size())
    return {ErrorCode::kMismatch, "the camera pose was given " + std::to_string(points.size()) + " points but " +
                                      std::to_string(pixels.size()) + " pixels"};
  bool finite = pose.rotation.coeffs().allFinite() && pose.translation.allFinite();
  for (const Eigen::Vector3d& point : points) finite = finite && point.allFinite();
  for (const Eigen::Vector2d& pixel : pixels) finite = finite && pixel.allFinite();
  if (!finite)
    return {ErrorCode::kInvalidArgument,
            "the camera pose was given a point, a pixel or an initial pose that is not a finite number"};
  return Status::Ok();
}

// Marks the inliers and returns the normal equations' matrix at the estimate, by a motion applied after it.
Matrix6d ClassifyAndAccumulate(const Camera& camera, std::span<const Eigen::Vector3d> points,
                               std::span<const Eigen::Vector2d> pixels, const CameraPoseOptions& options,
                               CameraPoseEstimate* estimate) {
  Matrix6d information = Matrix6d::Zero();
  estimate->inliers.assign(points.size(), 0);
  camera.Visit([&]<class Model>(const Model& model) {
    const ReprojectionKernel<Model> kernel(model, options.sigma_rep_px);
    Eigen::Vector2d residual;
    ReprojectionJacobian by_point;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d in_cam = estimate->cam_from_world * points[i];
      if (!kernel.ResidualAndJacobian(pixels[i], in_cam, &residual, &by_point)) continue;
      Eigen::Matrix<double, 2, 6> by_motion;
      by_motion << -by_point * Skew(in_cam), by_point;
      const double squared = residual.squaredNorm();
      information += Huber(squared, options.chi2_rep).derivative * by_motion.transpose() * by_motion;
      estimate->inliers[i] = squared <= options.chi2_rep;
      estimate->num_inliers += estimate->inliers[i];
    }
  });
  return information;
}

// The inverse, or false when a direction of the pose is not determined.
bool InvertInformation(const Matrix6d& information, Matrix6d* covariance) {
  const Vector6d scale = information.diagonal().cwiseSqrt();
  if (!(scale.minCoeff() > 0.0)) return false;
  const Vector6d inverse = scale.cwiseInverse();
  const Matrix6d scaled = inverse.asDiagonal() * information * inverse.asDiagonal();
  const Vector6d eigenvalues = EigenOfSymmetric(scaled).values;
  if (!(eigenvalues(0) > kFreeDirection * eigenvalues(5))) return false;
  const Matrix6d scaled_inverse = scaled.llt().solve(Matrix6d::Identity());
  *covariance = inverse.asDiagonal() * scaled_inverse * inverse.asDiagonal();
  return true;
}

// Eq. E7 over the points `used`; kDegenerate when Ceres finds no usable solution.
Result<CameraPoseEstimate> SolvePose(const Camera& camera, std::span<const Eigen::Vector3d> points,
                                     std::span<const Eigen::Vector2d> pixels, const std::vector<int>& used,
                                     const PoseIncrement& pose, const CameraPoseOptions& options) {
  Vector6d increment = Vector6d::Zero();
  const std::unique_ptr<ceres::LossFunction> loss(NewRobustLoss(options.chi2_rep, 1.0));
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  for (const int i : used)
    problem.AddResidualBlock(NewPoseReprojectionCost(camera, pose, points[i], pixels[i], options.sigma_rep_px),
                             loss.get(), increment.data());
  ceres::Solver::Options solver_options;
  solver_options.linear_solver_type = ceres::DENSE_QR;
  solver_options.max_num_iterations = options.max_iterations;
  solver_options.function_tolerance = options.function_tolerance;
  solver_options.num_threads = 1;
  solver_options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options, &problem, &summary);
  if (!summary.IsSolutionUsable() || !increment.allFinite())
    return {ErrorCode::kDegenerate, "the camera pose could not be computed"};

  CameraPoseEstimate estimate;
  estimate.cam_from_world = pose.Pose(increment);
  estimate.num_used = static_cast<int>(used.size());
  estimate.final_cost = summary.final_cost;
  estimate.iterations = static_cast<int>(summary.iterations.size()) - 1;
  estimate.converged = summary.termination_type == ceres::CONVERGENCE;
  estimate.message = summary.message;
  return estimate;
}

}  // namespace

void CameraPoseOptions::List(OptionTable& table) {
  table.BeginGroup("CameraPose", "the camera's pose on the geometry of the last frame, before the joint problem");
  table.Add("sigma_rep_px", &sigma_rep_px, "px", "standard deviation of a measured pixel", 1e-3, 1e3);
  table.Add("chi2_rep", &chi2_rep, "-", "Huber threshold on the squared normalized error (95 %, 2 dof)", 1e-3, 1e6);
  table.Add("max_iterations", &max_iterations, "iterations", "maximum number of Levenberg-Marquardt iterations", 1,
            10000);
  table.Add("function_tolerance", &function_tolerance, "ratio", "relative change of the cost at convergence", 0.0, 1.0);
  table.Add("min_points", &min_points, "points", "minimum number of usable points", 4, 10000);
}

Result<CameraPoseEstimate> EstimateCameraPose(const Camera& camera, std::span<const Eigen::Vector3d> points_in_world,
                                              std::span<const Eigen::Vector2d> pixels,
                                              const Rigid3& initial_cam_from_world, const CameraPoseOptions& options) {
  if (Status status = Check(points_in_world, pixels, initial_cam_from_world); !status.ok()) return status;
  std::vector<int> used;
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < points_in_world.size(); ++i) {
    if (!camera.Project(initial_cam_from_world * points_in_world[i])) continue;
    used.push_back(static_cast<int>(i));
    pivot += points_in_world[i];
  }
  if (static_cast<int>(used.size()) < options.min_points)
    return {ErrorCode::kInsufficient,
            "only " + std::to_string(used.size()) + " of " + std::to_string(points_in_world.size()) +
                " points lie in front of the camera; a pose needs " + std::to_string(options.min_points)};

  const PoseIncrement pose(initial_cam_from_world, pivot / static_cast<double>(used.size()));
  auto estimate = SolvePose(camera, points_in_world, pixels, used, pose, options);
  if (!estimate.ok()) return estimate.status();
  const Matrix6d information = ClassifyAndAccumulate(camera, points_in_world, pixels, options, &*estimate);
  if (!InvertInformation(information, &estimate->covariance))
    return {ErrorCode::kDegenerate,
            "the " + std::to_string(used.size()) + " points do not determine the camera's pose (they lie on a line)"};
  return estimate;
}

}  // namespace pliant
