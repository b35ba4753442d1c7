// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The camera's pose from known points and the rays that may see them, of which many may be wrong (docs/method.md, eq.
// R3). Points in map units in the world frame, rays of unit length in the camera frame.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

struct AbsolutePoseOptions {
  double max_error_px = 8;  // of a pair that agrees; the scene may have deformed since the points were seen
  int max_iterations = 500;
  double confidence = 0.999;
  int min_inliers = 12;
  double min_inlier_share = 0.25;

  void List(OptionTable& table);  // group "AbsolutePose"
};

struct AbsolutePose {
  Rigid3 cam_from_world;
  std::vector<int> inliers;  // indices of the pairs that agree, ascending
};

// RANSAC over three pairs (Kneip, Scaramuzza, Siegwart, CVPR 2011, by OpenGV). `focal_px` makes pixels of angles. The
// samples are the same in every call. Fails with kMismatch for counts that differ, kInvalidArgument for numbers that
// are not finite, kInsufficient for fewer than min_inliers pairs, kDegenerate when too few of them agree with any pose.
Result<AbsolutePose> EstimateAbsolutePose(std::span<const Eigen::Vector3d> points_in_world,
                                          std::span<const Eigen::Vector3d> rays, double focal_px,
                                          const AbsolutePoseOptions& options);

}  // namespace pliant
