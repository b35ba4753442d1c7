// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How well the views agree at discrete levels of the distance around a surface.
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/camera/camera.h"
#include "surface/view_matching.h"

namespace pliant {

// Level k of a pixel, k = -half to half, has the inverse distance center * (1 + k * step).
struct SweepLevels {
  cv::Mat center;  // CV_32FC1, inverse distances along the rays
  cv::Mat step;    // CV_32FC1, relative
  int half = 1;

  int count() const { return 2 * half + 1; }
  cv::Mat InverseDistances(int level) const;  // level from 0 to count() - 1
};

// (V5) A level each, CV_32FC1, 0 to 1: one less the mean correlation with the better half of the views that see the
// point; kUnknownCost where too few do.
struct SweepCosts {
  std::vector<cv::Mat> all;
  std::vector<cv::Mat> first;   // of the views with an even index alone; empty unless they are asked for
  std::vector<cv::Mat> second;  // of the others
};
inline constexpr float kUnknownCost = 1.0F;

SweepCosts Sweep(const ReferenceWindows& reference, const std::vector<MatchingView>& views, const Camera& camera,
                 const SweepLevels& levels, bool in_halves, int threads);

// Whether what a point itself moved counts, too. It is known by distances of tracked points, so that it tells none.
enum class Parallax { kOfAll, kOfCamera };

// The most that a point moves in a view by a relative change of its inverse distance, px, CV_32FC1, made smooth.
cv::Mat MotionByDistance(const std::vector<MatchingView>& views, const Camera& camera, const cv::Mat& inverse_distance,
                         Parallax parallax, int threads);

}  // namespace pliant
