// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/two_view/relative_pose.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>
#include <opencv2/calib3d.hpp>

#include "estimation/two_view/opengv_relative_pose.h"
#include "pliant/estimation/two_view/two_view_models.h"
#include "pliant/geometry/essential.h"
#include "pliant/geometry/triangulation.h"

namespace pliant {
namespace {

using Rays = std::span<const Eigen::Vector3d>;

constexpr double kUnitTolerance = 1e-6;   // of a ray's squared length: single precision somewhere upstream is accepted
constexpr double kStillAngleRad = 1e-10;  // two rays nearer than this are the same ray

int CountApart(Rays a, Rays b) {
  int count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += AngleBetween(a[i], b[i]) > kStillAngleRad ? 1 : 0;
  return count;
}

int CountApart(Rays rays, const Eigen::Vector3d& from) {
  return static_cast<int>(std::count_if(
      rays.begin(), rays.end(), [&](const Eigen::Vector3d& ray) { return AngleBetween(ray, from) > kStillAngleRad; }));
}

// Pairs that differ from each other in a view, up to kRelativePoseMinPoints of them.
int CountDistinct(Rays rays0, Rays rays1) {
  std::vector<std::size_t> distinct;
  for (std::size_t i = 0; i < rays0.size() && std::ssize(distinct) < kRelativePoseMinPoints; ++i) {
    const bool is_known = std::ranges::any_of(distinct, [&](std::size_t k) {
      return AngleBetween(rays0[k], rays0[i]) <= kStillAngleRad && AngleBetween(rays1[k], rays1[i]) <= kStillAngleRad;
    });
    if (!is_known) distinct.push_back(i);
  }
  return static_cast<int>(distinct.size());
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
  if (const int distinct = CountDistinct(rays0, rays1); distinct < kRelativePoseMinPoints)
    return {ErrorCode::kDegenerate, "only " + std::to_string(distinct) + " of the " + std::to_string(rays0.size()) +
                                        " correspondences differ from each other; a relative pose takes at least " +
                                        std::to_string(kRelativePoseMinPoints)};
  for (const Rays rays : {rays0, rays1})
    if (CountApart(rays, rays.front()) + 1 < kRelativePoseMinPoints)
      return {ErrorCode::kDegenerate, "nearly all rays of a view are the same ray: they carry no relative pose"};
  if (CountApart(rays0, rays1) < kRelativePoseMinPoints)
    return {ErrorCode::kDegenerate, "the two views are the same: nothing moved between them"};
  return Status::Ok();
}

// Whether the inliers' rays of a view may all lie in one plane through the camera: on a line of its image, as far as
// the error of the pairs can tell. Their root mean square distance from the best plane says so.
bool LieOnALine(Rays rays, const std::vector<char>& inliers, double max_error_rad) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  double count = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (inliers[i] == 0) continue;
    scatter += rays[i] * rays[i].transpose();
    ++count;
  }
  const double least = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvalues()[0];
  return std::sqrt(std::max(0.0, least) / count) <= std::sin(max_error_rad);
}

// Points on a line agree with many motions. A rotation alone is determined by two of them.
Status CheckSpread(Rays rays0, Rays rays1, const RelativePose& pose, double max_error_rad) {
  if (pose.cam1_from_cam0.translation.isZero(0.0)) return Status::Ok();
  for (const Rays rays : {rays0, rays1})
    if (LieOnALine(rays, pose.inliers, max_error_rad))
      return {ErrorCode::kDegenerate,
              "the " + std::to_string(pose.num_inliers) +
                  " correspondences that share one motion lie on a line of the image, to the error that is allowed: "
                  "they agree with many motions; give points that are spread over the image"};
  return Status::Ok();
}

// A motion whose translation has either sign; none where there is none.
std::optional<Rigid3> ByOpencv(Rays rays0, Rays rays1, double focal_px, Random random,
                               const RelativePoseOptions& options) {
  constexpr double kMinZ = 0.05;  // beyond 87 degrees a pixel of the plane z = 1 means nothing
  std::vector<cv::Point2d> points0;
  std::vector<cv::Point2d> points1;
  for (std::size_t i = 0; i < rays0.size(); ++i) {
    if (rays0[i].z() < kMinZ || rays1[i].z() < kMinZ) continue;
    points0.emplace_back(rays0[i].x() / rays0[i].z(), rays0[i].y() / rays0[i].z());
    points1.emplace_back(rays1[i].x() / rays1[i].z(), rays1[i].y() / rays1[i].z());
  }
  if (points0.size() < static_cast<std::size_t>(kRelativePoseMinPoints)) return std::nullopt;
  cv::UsacParams params;
  params.confidence = options.confidence;
  params.maxIterations = options.max_iterations;
  params.threshold = options.max_error_px / focal_px;
  params.score = cv::SCORE_METHOD_MAGSAC;
  params.loMethod = cv::LOCAL_OPTIM_SIGMA;
  params.sampler = cv::SAMPLING_UNIFORM;
  params.isParallel = false;
  params.randomGeneratorState = random.Index(1 << 30);
  cv::Mat inliers;
  const cv::Mat essential =
      cv::findEssentialMat(points0, points1, cv::Mat::eye(3, 3, CV_64F), cv::Mat::eye(3, 3, CV_64F), cv::noArray(),
                           cv::noArray(), inliers, params);
  if (essential.rows < 3 || essential.cols != 3) return std::nullopt;
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> e(essential.ptr<double>());
  const auto motions = DecomposeEssential(e);
  if (!motions.ok()) return std::nullopt;
  return Rigid3(motions->rotations[0], motions->translation);
}

int CountAgreeing(const Rigid3& motion, Rays rays0, Rays rays1, double max_error_rad) {
  int count = 0;
  for (std::size_t i = 0; i < rays0.size(); ++i)
    count += AgreesWithMotion(motion, rays0[i], rays1[i], max_error_rad) ? 1 : 0;
  return count;
}

// The motion of the dominant plane that more points agree with; its sign puts the plane in front.
Result<Rigid3> ByHomography(Rays rays0, Rays rays1, double focal_px, double max_error_rad, Random random,
                            const RelativePoseOptions& options) {
  const auto plane = FitHomography(rays0, rays1, focal_px, options.max_error_px, random);
  if (!plane.ok()) return plane.status();
  const std::vector<Rigid3> motions = MotionsFromHomography(plane->cam1_from_cam0, rays0);
  if (motions.empty()) return {ErrorCode::kDegenerate, "the homography of the views is a rotation: nothing moved"};
  return *std::max_element(motions.begin(), motions.end(), [&](const Rigid3& a, const Rigid3& b) {
    return CountAgreeing(a, rays0, rays1, max_error_rad) < CountAgreeing(b, rays0, rays1, max_error_rad);
  });
}

// Of a motion with either sign the one with more of its inliers in front (docs/method.md, eq. I3).
Result<Rigid3> FacingForwards(const Rigid3& motion, Rays rays0, Rays rays1, double max_error_rad) {
  std::vector<Eigen::Vector3d> inliers0;
  std::vector<Eigen::Vector3d> inliers1;
  for (std::size_t i = 0; i < rays0.size(); ++i) {
    if (std::abs(SampsonErrorRad(motion, rays0[i], rays1[i])) > std::sqrt(2.0) * max_error_rad) continue;
    inliers0.push_back(rays0[i]);
    inliers1.push_back(rays1[i]);
  }
  const auto choice = ChooseMotion(EssentialFromMotion(motion), inliers0, inliers1);
  if (!choice.ok()) return choice.status();
  return choice->cam1_from_cam0;
}

Result<Rigid3> FindMotion(Rays rays0, Rays rays1, double focal_px, double max_error_rad, Random random,
                          const RelativePoseOptions& options) {
  switch (options.solver) {
    case RelativePoseSolver::kHomography:
      return ByHomography(rays0, rays1, focal_px, max_error_rad, random, options);
    case RelativePoseSolver::kRotationOnly: {
      const auto rotation = FitRotation(rays0, rays1, focal_px, options.max_error_px);
      if (!rotation.ok()) return rotation.status();
      return Rigid3(rotation->cam1_from_cam0, Eigen::Vector3d::Zero());
    }
    default: {
      const std::optional<Rigid3> found = options.solver == RelativePoseSolver::kOpencvUsac
                                              ? ByOpencv(rays0, rays1, focal_px, random, options)
                                              : SampleMotion(rays0, rays1, focal_px, random, options);
      if (!found)
        return {ErrorCode::kInsufficient,
                "no motion explains any sample of the " + std::to_string(rays0.size()) + " correspondences"};
      return FacingForwards(*found, rays0, rays1, max_error_rad);
    }
  }
}

// Whether samples can have found what a share of the pairs agrees on: one of them was clean with some probability. A
// few pairs agree with any motion, and the best of many motions has more of them.
bool CanBeFound(double inlier_share, const RelativePoseOptions& options) {
  constexpr double kMinProbability = 0.001;
  const double clean = std::pow(inlier_share, SampleSize(options.solver));
  return 1.0 - std::pow(1.0 - clean, options.max_iterations) >= kMinProbability;
}

}  // namespace

bool MeetInFront(const Rigid3& cam1_from_cam0, const Eigen::Vector3d& ray0, const Eigen::Vector3d& ray1,
                 double max_error_rad) {
  // Rays that noise alone may have made parallel or divergent are not evidence against the motion.
  return ParallaxAngle(cam1_from_cam0.rotation, ray0, ray1) <= std::sqrt(2.0) * max_error_rad ||
         TriangulateIdwm(cam1_from_cam0, ray0, ray1).ok();
}

bool AgreesWithMotion(const Rigid3& cam1_from_cam0, const Eigen::Vector3d& ray0, const Eigen::Vector3d& ray1,
                      double max_error_rad) {
  // Without a translation a pair's rays have to be one and the same: the error is shared by both.
  if (cam1_from_cam0.translation.isZero(0.0))
    return AngleBetween(cam1_from_cam0.rotation * ray0, ray1) <= 2.0 * max_error_rad;
  // Sampson's error joins both views, the threshold is per view.
  if (!(std::abs(SampsonErrorRad(cam1_from_cam0, ray0, ray1)) <= std::sqrt(2.0) * max_error_rad)) return false;
  return MeetInFront(cam1_from_cam0, ray0, ray1, max_error_rad);
}

Result<RelativePose> EstimateRelativePose(Rays rays0, Rays rays1, double focal_px, Random random,
                                          const RelativePoseOptions& options) {
  if (Status status = CheckRays(rays0, rays1); !status.ok()) return status;
  const double max_error_rad = std::atan(options.max_error_px / focal_px);
  const auto motion = FindMotion(rays0, rays1, focal_px, max_error_rad, random, options);
  if (!motion.ok()) return motion.status();

  RelativePose pose;
  pose.cam1_from_cam0 = *motion;
  pose.inliers.resize(rays0.size());
  for (std::size_t i = 0; i < rays0.size(); ++i) {
    pose.inliers[i] = AgreesWithMotion(pose.cam1_from_cam0, rays0[i], rays1[i], max_error_rad) ? 1 : 0;
    pose.num_inliers += pose.inliers[i];
  }
  if (pose.num_inliers < kRelativePoseMinPoints)
    return Status(ErrorCode::kInsufficient, "only " + std::to_string(pose.num_inliers) + " of " +
                                                std::to_string(rays0.size()) + " correspondences share one motion");
  if (!CanBeFound(static_cast<double>(pose.num_inliers) / static_cast<double>(rays0.size()), options))
    return Status(ErrorCode::kInsufficient,
                  "only " + std::to_string(pose.num_inliers) + " of " + std::to_string(rays0.size()) +
                      " correspondences share one motion: so few agree by chance, and a motion that they alone "
                      "determine is hardly ever sampled");
  if (Status status = CheckSpread(rays0, rays1, pose, max_error_rad); !status.ok()) return status;
  return pose;
}

}  // namespace pliant
