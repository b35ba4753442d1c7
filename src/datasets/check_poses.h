// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How well images fit on each other when one is warped into the other by its depth and their poses, for every way in
// which poses are usually meant.
#pragma once

#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/camera/camera.h"
#include "pliant/datasets/check_sequence.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

struct PosedImage {
  cv::Mat structure;  // of FineStructure
  cv::Mat depth_mm;   // CV_32FC1, 0 = none
  Rigid3 world_from_cam;
};

// CV_32FC1: what is finer than shading, by its local size.
cv::Mat FineStructure(const cv::Mat& image);

// All readings, the poses as they are first.
std::vector<PoseReading> CorrelateReadings(const std::vector<std::pair<const PosedImage*, const PosedImage*>>& pairs,
                                           const Camera& camera, int max_points);

}  // namespace pliant
