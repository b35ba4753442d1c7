// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A rectified pair whose left image is a prepared frame: where its points are in the right image.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pliant/camera/camera.h"
#include "pliant/tracking/stereo_start.h"
#include "pliant/tracking/tracker.h"

namespace pliant {

// MatchAlongRows of pixels of the left image; `right` is 8-bit, of its size.
std::vector<std::optional<RowMatch>> MatchPair(const TrackerFrame& left, const cv::Mat& right,
                                               std::span<const Eigen::Vector2d> pixels, const TrackerOptions& options,
                                               int threads);

// Corners of the left image with their depths in mm (docs/method.md, eq. B5), the strongest first; `camera` is the
// rectified pinhole one of both. Of at most options.corners.max_corners corners those that the right image shows.
std::vector<PixelDepth> PointsOfPair(const TrackerFrame& left, const cv::Mat& right, const Camera& camera,
                                     double baseline_mm, const TrackerOptions& options, int threads);

}  // namespace pliant
