// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Points of a sharp image in one that is blurred, by motion or by lack of focus (docs/method.md, eq. P10): the sharp
// image is blurred too, as much as makes the two resemble each other, and both are made as small as the blur allows.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "pliant/tracking/tracker.h"
#include "pliant/tracking/tracks/point_tracker.h"

namespace pliant {

// One result a prediction. `pixels[k]` is where the point of predictions[k] is in the sharp image.
std::vector<PointTrack> TrackIntoBlur(const PreparedFrame& sharp, const PreparedFrame& blurred,
                                      std::span<const Eigen::Vector2d> pixels,
                                      std::span<const PointPrediction> predictions, const PointTrackerOptions& options,
                                      int threads);

// How many of them were found.
int CountTracked(std::span<const PointTrack> tracks);

}  // namespace pliant
