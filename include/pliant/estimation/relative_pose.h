// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The motion between two views from matched unit rays, against outliers: RANSAC with the five-point solver (Nister,
// PAMI 2004) through OpenGV (docs/method.md, eq. I1 to I3). Translations have unit length: two views have no scale.
// The result depends on the inputs and on `random` alone: OpenGV's own generator is held at its fixed seed, and the
// correspondences are handed to it in an order drawn from `random`.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/random.h"
#include "pliant/base/status.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

struct RelativePoseOptions {
  double max_error_px = 1.5;  // a correspondence this far from the model (per view, at the mean focal length) is out
  int max_iterations = 300;   // 99.9 % sure of a clean sample up to half outliers
  double confidence = 0.999;  // stop when a clean sample was drawn with this probability
};

struct RelativePose {
  Rigid3 cam1_from_cam0;      // |translation| = 1; as RANSAC left it, not refined
  std::vector<char> inliers;  // one a correspondence, 0 or 1
  int num_inliers = 0;
  int iterations = 0;
};

// Whether a correspondence agrees with a motion: its epipolar error is at most max_error_rad a view, and its rays meet
// in front of both cameras, or are too nearly parallel to say.
bool AgreesWithMotion(const Rigid3& cam1_from_cam0, const Eigen::Vector3d& ray0, const Eigen::Vector3d& ray1,
                      double max_error_rad);

// The least number of correspondences: five make the model, three choose among its solutions.
inline constexpr int kRelativePoseMinPoints = 8;

// Fails with kInvalidArgument (a ray that is not a unit vector, counts that differ), kInsufficient (too few
// correspondences or inliers), kDegenerate (all rays alike in a view, or no ray moves).
Result<RelativePose> EstimateRelativePose(std::span<const Eigen::Vector3d> rays0,
                                          std::span<const Eigen::Vector3d> rays1, double focal_px, Random random,
                                          const RelativePoseOptions& options);

}  // namespace pliant
