// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The normals of the surface that a depth image shows.
#pragma once

#include <opencv2/core/mat.hpp>

#include "pliant/camera/camera.h"

namespace pliant {

// CV_32FC3 of the depth's size: unit vectors in the camera's frame (x right, y down, z ahead), towards the camera; zero
// where there is none. `depth`: CV_32FC1, the camera's size, z along the optical axis, 0 = none. The plane that fits
// the known inverse depths in the window of `window_px` around a pixel, least squares (docs/method.md, eq. V15); none
// where fewer than half of these pixels have a depth.
cv::Mat NormalsOfDepth(const Camera& camera, const cv::Mat& depth, int window_px);

}  // namespace pliant
