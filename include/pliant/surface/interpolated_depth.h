// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the tracked points alone say of the depth everywhere: the baseline of every dense depth.
#pragma once

#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/camera/camera.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/scene/frame_report.h"

namespace pliant {

// (V1) A thin plate through the inverse distances: CV_32FC1 of the camera's size, z along the optical axis, map units,
// 0 where no ray projects. Nothing with fewer than 12 points in the image.
std::optional<cv::Mat> InterpolatedDepth(const Camera& camera, const Rigid3& cam_from_world,
                                         const std::vector<PointObservation>& observations);

}  // namespace pliant
