// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The simpler models of two views, which an essential matrix fits as well and then means nothing: no translation (a
// rotation carries every ray), and a plane (a homography carries every ray, and up to two motions explain it).
// All on unit rays, x1 = cam1_from_cam0 * x0, errors in px at the mean focal length (docs/method.md, eq. I5, I8).
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/random.h"
#include "pliant/base/status.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

struct RotationFit {
  Eigen::Quaterniond cam1_from_cam0 = Eigen::Quaterniond::Identity();
  int num_inliers = 0;         // correspondences within max_error_px
  double median_error_px = 0;  // of the angle between R f0 and f1, over all correspondences
  double median_error_rad = 0;
};
// The rotation that best carries rays0 to rays1: closed form (Wahba's problem by SVD), reweighted with a Cauchy loss
// until it rests. Fails with kInsufficient below three correspondences, kInvalidArgument for counts that differ.
Result<RotationFit> FitRotation(std::span<const Eigen::Vector3d> rays0, std::span<const Eigen::Vector3d> rays1,
                                double focal_px, double max_error_px);

struct HomographyFit {
  Eigen::Matrix3d cam1_from_cam0 = Eigen::Matrix3d::Identity();  // f1 ~ H f0; middle singular value 1, H f0 . f1 > 0
  std::vector<char> inliers;
  int num_inliers = 0;
};
// RANSAC on four correspondences, then least squares on the inliers. Fails with kInsufficient below four.
Result<HomographyFit> FitHomography(std::span<const Eigen::Vector3d> rays0, std::span<const Eigen::Vector3d> rays1,
                                    double focal_px, double max_error_px, Random random);

// The motions that explain a plane's homography H = R + t n' / d (Ma, Soatto, Kosecka and Sastry, "An Invitation to 3-D
// Vision", 5.3.3), each with the sign that puts the plane in front of the camera for most of the rays: two, or none
// where H is a rotation. |translation| = 1.
std::vector<Rigid3> MotionsFromHomography(const Eigen::Matrix3d& homography, std::span<const Eigen::Vector3d> rays0);

}  // namespace pliant
