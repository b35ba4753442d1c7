// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include <opengv/absolute_pose/CentralAbsoluteAdapter.hpp>
#include <opengv/sac/Ransac.hpp>
#include <opengv/sac_problems/absolute_pose/AbsolutePoseSacProblem.hpp>

#include "pliant/estimation/pose/absolute_pose.h"

namespace pliant {

void AbsolutePoseOptions::List(OptionTable& table) {
  table.BeginGroup("AbsolutePose", "camera pose without an initial guess, by RANSAC over three points");
  table.Add("max_error_px", &max_error_px, "px",
            "maximum reprojection error of an inlier; the scene may have deformed since", 0.1, 100);
  table.Add("max_iterations", &max_iterations, "-", "maximum number of RANSAC samples", 1, 1000000);
  table.Add("confidence", &confidence, "-", "probability that one sample is free of outliers", 0.5, 0.999999);
  table.Add("min_inliers", &min_inliers, "-", "minimum number of inliers", 6, 100000);
  table.Add("min_inlier_share", &min_inlier_share, "-", "minimum share of inliers among all matches", 0, 1);
}

Result<AbsolutePose> EstimateAbsolutePose(std::span<const Eigen::Vector3d> points_in_world,
                                          std::span<const Eigen::Vector3d> rays, double focal_px,
                                          const AbsolutePoseOptions& options) {
  using Problem = opengv::sac_problems::absolute_pose::AbsolutePoseSacProblem;
  if (points_in_world.size() != rays.size())
    return Status(ErrorCode::kMismatch,
                  std::to_string(points_in_world.size()) + " points, but " + std::to_string(rays.size()) + " rays");
  const auto finite = [](const Eigen::Vector3d& v) { return v.allFinite(); };
  if (!std::all_of(points_in_world.begin(), points_in_world.end(), finite) ||
      !std::all_of(rays.begin(), rays.end(), finite))
    return Status(ErrorCode::kInvalidArgument, "a point or a ray is not finite");
  if (static_cast<int>(rays.size()) < options.min_inliers)
    return Status(ErrorCode::kInsufficient,
                  std::to_string(rays.size()) + " matches, of at least " + std::to_string(options.min_inliers));
  const opengv::points_t points(points_in_world.begin(), points_in_world.end());
  const opengv::bearingVectors_t bearings(rays.begin(), rays.end());
  opengv::absolute_pose::CentralAbsoluteAdapter adapter(bearings, points);  // keeps references to both
  const double threshold = 1.0 - std::cos(std::atan(options.max_error_px / focal_px));
  opengv::sac::Ransac<Problem> ransac(options.max_iterations, threshold, options.confidence);
  ransac.sac_model_ = std::make_shared<Problem>(adapter, Problem::KNEIP, /*randomSeed=*/false);
  const bool found = ransac.computeModel();
  const auto needed =
      std::max<double>(options.min_inliers, options.min_inlier_share * static_cast<double>(rays.size()));
  const std::size_t inliers = found ? ransac.inliers_.size() : 0;
  if (static_cast<double>(inliers) < needed || !ransac.model_coefficients_.allFinite())
    return Status(ErrorCode::kDegenerate,
                  std::to_string(inliers) + " of " + std::to_string(rays.size()) + " matches agree with one pose");
  const opengv::transformation_t& world_from_cam = ransac.model_coefficients_;
  AbsolutePose pose;
  pose.cam_from_world =
      Rigid3(Eigen::Matrix3d(world_from_cam.leftCols<3>()), Eigen::Vector3d(world_from_cam.col(3))).Inverse();
  pose.inliers = ransac.inliers_;
  std::sort(pose.inliers.begin(), pose.inliers.end());
  return pose;
}

}  // namespace pliant
