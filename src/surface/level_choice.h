// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The best level of every pixel, and how sure it is.
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "surface/plane_sweep.h"

namespace pliant {

// Levels with fractions, from -half to half, CV_32FC1. Where the best level is the first or the last one it is that.
struct ChosenLevels {
  cv::Mat level;
  cv::Mat at_end;     // CV_8UC1, 255 where the best level is the first or last one
  cv::Mat cost;       // CV_32FC1, of the nearest whole level, before smoothing
  cv::Mat curvature;  // CV_32FC1, second derivative of the costs around it by the level, before smoothing
};

// (V6) By semi-global matching; `center_weight` is the cost of the outermost levels, which grows with the square of the
// level.
ChosenLevels ChooseLevels(const std::vector<cv::Mat>& costs, int half, double center_weight, int threads);

}  // namespace pliant
