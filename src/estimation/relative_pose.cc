// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/relative_pose.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <string>

#include <opengv/relative_pose/CentralRelativeAdapter.hpp>
#include <opengv/sac/Ransac.hpp>
#include <opengv/sac_problems/relative_pose/CentralRelativePoseSacProblem.hpp>

#include "pliant/geometry/essential.h"
#include "pliant/geometry/triangulation.h"

namespace pliant {
namespace {

using Rays = std::span<const Eigen::Vector3d>;
using RansacProblem = opengv::sac_problems::relative_pose::CentralRelativePoseSacProblem;

constexpr double kUnitTolerance = 1e-6;   // of a ray's squared length: single precision somewhere upstream is accepted
constexpr double kStillAngleRad = 1e-10;  // two rays nearer than this are the same ray

// A hypothesis is scored on at most this many correspondences: beyond it the time grows and the choice does not change.
constexpr std::size_t kMaxScored = 200;

int CountApart(Rays a, Rays b) {
  int count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += AngleBetween(a[i], b[i]) > kStillAngleRad ? 1 : 0;
  return count;
}

int CountApart(Rays rays, const Eigen::Vector3d& from) {
  return static_cast<int>(std::count_if(
      rays.begin(), rays.end(), [&](const Eigen::Vector3d& ray) { return AngleBetween(ray, from) > kStillAngleRad; }));
}

Status CheckRays(Rays rays0, Rays rays1) {
  if (rays0.size() != rays1.size())
    return {ErrorCode::kInvalidArgument, "the two views of a relative pose have " + std::to_string(rays0.size()) +
                                             " and " + std::to_string(rays1.size()) + " rays: they must match"};
  for (const Rays rays : {rays0, rays1})
    for (const Eigen::Vector3d& ray : rays)
      if (!(std::abs(ray.squaredNorm() - 1.0) <= kUnitTolerance))
        return {ErrorCode::kInvalidArgument, "a ray of a relative pose is not a unit vector"};
  if (rays0.size() < static_cast<std::size_t>(kRelativePoseMinPoints))
    return {ErrorCode::kInsufficient, "a relative pose takes at least " + std::to_string(kRelativePoseMinPoints) +
                                          " correspondences; there are " + std::to_string(rays0.size())};
  for (const Rays rays : {rays0, rays1})
    if (CountApart(rays, rays.front()) + 1 < kRelativePoseMinPoints)
      return {ErrorCode::kDegenerate, "nearly all rays of a view are the same ray: they carry no relative pose"};
  if (CountApart(rays0, rays1) < kRelativePoseMinPoints)
    return {ErrorCode::kDegenerate, "the two views are the same: nothing moved between them"};
  return Status::Ok();
}

// The first `count` entries of a random order of 0 .. size - 1 (Fisher and Yates).
std::vector<std::size_t> RandomOrder(std::size_t size, std::size_t count, Random random) {
  std::vector<std::size_t> order(size);
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t i = 0; i < count; ++i)
    std::swap(order[i], order[i + static_cast<std::size_t>(random.Index(static_cast<int>(size - i)))]);
  order.resize(count);
  return order;
}

struct RansacModel {
  bool found = false;
  Rigid3 cam1_from_cam0;
  int iterations = 0;
};

RansacModel RunRansac(Rays rays0, Rays rays1, double focal_px, Random random, const RelativePoseOptions& options) {
  opengv::bearingVectors_t bearings0;
  opengv::bearingVectors_t bearings1;
  for (const std::size_t i : RandomOrder(rays0.size(), std::min(rays0.size(), kMaxScored), random)) {
    bearings0.push_back(rays0[i]);
    bearings1.push_back(rays1[i]);
  }
  opengv::relative_pose::CentralRelativeAdapter adapter(bearings0, bearings1);  // keeps references to both
  opengv::sac::Ransac<RansacProblem> ransac(
      options.max_iterations, 2.0 * (1.0 - std::cos(std::atan(options.max_error_px / focal_px))), options.confidence);
  ransac.sac_model_ = std::make_shared<RansacProblem>(adapter, RansacProblem::NISTER, /*randomSeed=*/false);
  RansacModel model;
  model.found =
      ransac.computeModel() && ransac.model_coefficients_.allFinite() && ransac.model_coefficients_.col(3).norm() > 0.0;
  model.iterations = ransac.iterations_;
  if (!model.found) return model;
  // OpenGV's model maps its second view into its first, with a translation of any length.
  const Rigid3 cam0_from_cam1(Eigen::Matrix3d(ransac.model_coefficients_.leftCols<3>()),
                              ransac.model_coefficients_.col(3).normalized());
  model.cam1_from_cam0 = cam0_from_cam1.Inverse();
  return model;
}

}  // namespace

bool AgreesWithMotion(const Rigid3& cam1_from_cam0, const Eigen::Vector3d& ray0, const Eigen::Vector3d& ray1,
                      double max_error_rad) {
  // Sampson's error joins both views, the threshold is per view.
  if (!(std::abs(SampsonErrorRad(cam1_from_cam0, ray0, ray1)) <= std::sqrt(2.0) * max_error_rad)) return false;
  // Rays that noise alone may have made parallel or divergent are not evidence against the motion.
  return ParallaxAngle(cam1_from_cam0.rotation, ray0, ray1) <= std::sqrt(2.0) * max_error_rad ||
         TriangulateIdwm(cam1_from_cam0, ray0, ray1).ok();
}

Result<RelativePose> EstimateRelativePose(Rays rays0, Rays rays1, double focal_px, Random random,
                                          const RelativePoseOptions& options) {
  if (Status status = CheckRays(rays0, rays1); !status.ok()) return status;
  const RansacModel model = RunRansac(rays0, rays1, focal_px, random, options);
  if (!model.found)
    return Status(ErrorCode::kInsufficient,
                  "no motion explains any sample of the " + std::to_string(rays0.size()) + " correspondences");

  const double max_error_rad = std::atan(options.max_error_px / focal_px);
  RelativePose pose;
  pose.iterations = model.iterations;
  std::vector<Eigen::Vector3d> inliers0;
  std::vector<Eigen::Vector3d> inliers1;
  for (std::size_t i = 0; i < rays0.size(); ++i) {
    if (std::abs(SampsonErrorRad(model.cam1_from_cam0, rays0[i], rays1[i])) > std::sqrt(2.0) * max_error_rad) continue;
    inliers0.push_back(rays0[i]);
    inliers1.push_back(rays1[i]);
  }
  const auto choice = ChooseMotion(EssentialFromMotion(model.cam1_from_cam0), inliers0, inliers1);
  if (!choice.ok()) return choice.status();
  pose.cam1_from_cam0 = choice->cam1_from_cam0;

  pose.inliers.resize(rays0.size());
  for (std::size_t i = 0; i < rays0.size(); ++i) {
    pose.inliers[i] = AgreesWithMotion(pose.cam1_from_cam0, rays0[i], rays1[i], max_error_rad) ? 1 : 0;
    pose.num_inliers += pose.inliers[i];
  }
  if (pose.num_inliers < kRelativePoseMinPoints)
    return Status(ErrorCode::kInsufficient, "only " + std::to_string(pose.num_inliers) + " of " +
                                                std::to_string(rays0.size()) + " correspondences share one motion");
  return pose;
}

}  // namespace pliant
