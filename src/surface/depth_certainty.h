// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How certain the depth at a pixel is, as its images tell it.
#pragma once

#include <opencv2/core/mat.hpp>

#include "surface/level_choice.h"
#include "surface/plane_sweep.h"
#include "surface/sized_scene.h"

namespace pliant {

inline constexpr double kMinSigmaLevels = 0.05;  // of a chosen level: no match is more exact

// How far the levels are apart that either half of the views alone chooses, CV_32FC1; 0 where there is one view.
cv::Mat Disagreement(const SweepCosts& costs, int half, int threads);

// (V7) Standard deviation of a level, CV_32FC1, 0 where the cost has no minimum: by the noise of the images and the
// curvature of the cost, times what the disagreement asks for.
cv::Mat LevelSigmas(const SizedScene& scene, const ChosenLevels& chosen, const cv::Mat& disagreement);

// (V7) By what the depths of tracked points, which many more images have seen, differ from those at their pixels, by
// the sigma there (relative): a factor for these, at least 1.
double FactorByPoints(const SizedCamera& camera, const SparseSurface& surface, const cv::Mat& inverse_distance,
                      const cv::Mat& sigmas);

// (V8) What an error of the interpolated motion does to a depth, relative, CV_32FC1. `parallax`: MotionByDistance.
cv::Mat MotionSigmas(const SizedScene& sized, const Scene& scene, const cv::Mat& inverse_distance,
                     const cv::Mat& parallax);

// Whether windows are about as alike as noise lets equal ones be.
bool AreAlike(const ReferenceWindows& reference, float cost, int x, int y, double min_correlation);

}  // namespace pliant
