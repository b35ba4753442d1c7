// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Small holes of a depth image, filled from their rim (docs/method.md, eq. V14). What is filled is no measurement.
#pragma once

#include <opencv2/core/mat.hpp>

#include "pliant/camera/camera.h"
#include "pliant/surface/dense_depth.h"

namespace pliant {

// Fills connected holes of at most `max_area_px` pixels: a plane of the inverse depth through the known pixels around,
// bent so that it meets the rim; the standard deviation is that of these pixels and of what they are off the plane. A
// hole stays where it touches the image's border, where one of its pixels is not `tissue` (CV_8UC1, 0 = not; of a
// highlight it is), and where the pixels around are no plane within their standard deviation, or one that is steeper
// than a surface can be: there is an edge. Returns CV_8UC1, the camera's size, 255 where it was filled.
cv::Mat FillHoles(const Camera& camera, const cv::Mat& tissue, int max_area_px, DenseDepth* dense);

}  // namespace pliant
