// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/two_view/two_view_refinement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <ceres/ceres.h>

#include "estimation/ceres_support.h"
#include "estimation/ray_residuals.h"
#include "estimation/two_view/opengv_relative_pose.h"
#include "pliant/base/statistics.h"
#include "pliant/geometry/decompositions.h"
#include "pliant/geometry/triangulation.h"

namespace pliant {
namespace {

using Rays = std::span<const Eigen::Vector3d>;
// Blocks: rotation (x, y, z, w), translation of unit length. Unit: px.
class SampsonCost final : public ceres::SizedCostFunction<1, 4, 3> {
 public:
  SampsonCost(const Eigen::Vector3d& ray0, const Eigen::Vector3d& ray1, double focal_px)
      : ray0_(ray0), ray1_(ray1), focal_px_(focal_px) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    SampsonResidual residual;
    if (!EvaluateSampson(ReadQuaternion(parameters[0]), Eigen::Map<const Eigen::Vector3d>(parameters[1]), ray0_, ray1_,
                         &residual))
      return false;
    residuals[0] = focal_px_ * residual.value;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) Eigen::Map<Eigen::RowVector4d>{jacobians[0]} = focal_px_ * residual.by_rotation;
    if (jacobians[1] != nullptr) Eigen::Map<Eigen::RowVector3d>{jacobians[1]} = focal_px_ * residual.by_translation;
    return true;
  }

 private:
  Eigen::Vector3d ray0_;
  Eigen::Vector3d ray1_;
  double focal_px_;
};

Status CheckCorrespondences(Rays rays0, Rays rays1) {
  if (rays0.size() != rays1.size())
    return {ErrorCode::kInvalidArgument, "the two views to refine have different numbers of rays"};
  if (rays0.size() < 6)
    return {ErrorCode::kInsufficient,
            "refining a relative pose takes at least six correspondences; there are " + std::to_string(rays0.size())};
  return Status::Ok();
}

// The solution with its cost, its spread and the direction's covariance: the inverse of the weighted normal equations,
// the rotation eliminated, times the errors' variance.
TwoViewRefinement Assessed(const Rigid3& cam1_from_cam0, Rays rays0, Rays rays1, double focal_px,
                           double loss_scale_px) {
  TwoViewRefinement refinement;
  refinement.cam1_from_cam0 = cam1_from_cam0;
  const Eigen::Quaterniond& q = cam1_from_cam0.rotation;
  const Eigen::Vector3d& t = cam1_from_cam0.translation;
  Eigen::Matrix<double, 4, 3, Eigen::RowMajor> q_plus;
  Eigen::Matrix<double, 3, 2, Eigen::RowMajor> t_plus;
  ceres::EigenQuaternionManifold().PlusJacobian(q.coeffs().data(), q_plus.data());
  ceres::SphereManifold<3>().PlusJacobian(t.data(), t_plus.data());

  Eigen::Matrix<double, 5, 5> normal_equations = Eigen::Matrix<double, 5, 5>::Zero();
  std::vector<double> errors_px;
  for (std::size_t i = 0; i < rays0.size(); ++i) {
    SampsonResidual residual;
    if (!EvaluateSampson(q, t, rays0[i], rays1[i], &residual)) continue;
    const double error_px = focal_px * residual.value;
    errors_px.push_back(std::abs(error_px));
    Eigen::Matrix<double, 1, 5> row;
    row << residual.by_rotation * q_plus, residual.by_translation * t_plus;
    const double relative = std::pow(error_px / loss_scale_px, 2);
    const double weight = 1.0 / (1.0 + relative);
    refinement.cost += 0.5 * loss_scale_px * loss_scale_px * std::log1p(relative);
    normal_equations += weight * focal_px * focal_px * row.transpose() * row;
  }
  refinement.spread_px = errors_px.empty() ? 0.0 : kMedianToSigma * Median(errors_px);

  const Eigen::Matrix2d direction =
      normal_equations.bottomRightCorner<2, 2>() -
      normal_equations.bottomLeftCorner<2, 3>() *
          normal_equations.topLeftCorner<3, 3>().ldlt().solve(normal_equations.topRightCorner<3, 2>());
  const Eigen::Vector2d eigenvalues = EigenOfSymmetric(direction).values;
  for (int k = 0; k < 2; ++k)
    refinement.direction_sigma_rad[k] = eigenvalues[k] > 0.0 ? refinement.spread_px / std::sqrt(eigenvalues[k])
                                                             : std::numeric_limits<double>::infinity();
  return refinement;
}

}  // namespace

Result<TwoViewRefinement> RefineTwoView(const Rigid3& start, Rays rays0, Rays rays1, double focal_px,
                                        const RefinementOptions& options) {
  if (Status status = CheckCorrespondences(rays0, rays1); !status.ok()) return status;
  Eigen::Vector4d rotation = start.rotation.coeffs();
  Eigen::Vector3d translation = start.translation.normalized();
  ceres::CauchyLoss loss(options.loss_scale_px);
  ceres::EigenQuaternionManifold rotation_manifold;
  ceres::SphereManifold<3> translation_manifold;
  ceres::Problem problem(BorrowingOptions());
  for (std::size_t i = 0; i < rays0.size(); ++i)
    problem.AddResidualBlock(new SampsonCost(rays0[i], rays1[i], focal_px), &loss, rotation.data(), translation.data());
  problem.SetManifold(rotation.data(), &rotation_manifold);
  problem.SetManifold(translation.data(), &translation_manifold);

  ceres::Solver::Summary summary;
  // QR, because a competing motion's start may leave the normal equations singular, of which Ceres complains on stderr.
  ceres::Solve(RigidSolverOptions(ceres::DENSE_QR, options.max_iterations), &problem, &summary);
  if (!summary.IsSolutionUsable())
    return Status(ErrorCode::kDegenerate, "the refinement of the relative pose found no step that improves it");

  return Assessed(Rigid3(ReadQuaternion(rotation.data()), translation.normalized()), rays0, rays1, focal_px,
                  options.loss_scale_px);
}

Result<TwoViewRefinement> RefineTwoViewByOpengv(const Rigid3& start, Rays rays0, Rays rays1, double focal_px,
                                                const RefinementOptions& options) {
  if (Status status = CheckCorrespondences(rays0, rays1); !status.ok()) return status;
  const auto refined = RefineMotionByOpengv(start, rays0, rays1);
  if (!refined.ok()) return refined.status();
  return Assessed(*refined, rays0, rays1, focal_px, options.loss_scale_px);
}

Result<TwoViewRefinement> AssessTwoView(const Rigid3& cam1_from_cam0, Rays rays0, Rays rays1, double focal_px,
                                        const RefinementOptions& options) {
  if (Status status = CheckCorrespondences(rays0, rays1); !status.ok()) return status;
  return Assessed(Rigid3(cam1_from_cam0.rotation, cam1_from_cam0.translation.normalized()), rays0, rays1, focal_px,
                  options.loss_scale_px);
}

}  // namespace pliant
