// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A rectified pair whose left image is a prepared frame: the corners of that image with their depths.
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/camera/camera.h"
#include "pliant/tracking/tracker.h"

namespace pliant {

// Corners of the left image with their depths in mm (docs/method.md, eq. B5), the strongest first; `right` is 8-bit, of
// the left one's size, `camera` the rectified pinhole one of both. Of at most options.corners.max_corners corners those
// that the right image shows.
std::vector<PixelDepth> PointsOfPair(const PreparedFrame& left, const cv::Mat& right, const Camera& camera,
                                     double baseline_mm, const TrackerOptions& options, int threads);

}  // namespace pliant
