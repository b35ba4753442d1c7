// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A point cloud as the depth image of a camera.
#pragma once

#include <span>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pliant/camera/camera.h"

namespace pliant {

// CV_32FC1, z along the optical axis, 0 = none: of the points, in the camera's frame, around each pixel the weighted
// mean depth (docs/method.md, eq. C1). The cloud is what the camera sees: nothing in it hides anything else.
cv::Mat DepthOfCloud(std::span<const Eigen::Vector3d> points_in_cam, const Camera& camera);

}  // namespace pliant
