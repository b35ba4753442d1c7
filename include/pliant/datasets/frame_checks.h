// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What comes with images, whether they are files or given one by one: their times, and other programs' depth.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include <opencv2/core/types.hpp>

#include "pliant/base/status.h"

namespace pliant {

// The median difference of successive times; 0 of fewer than two.
double MedianStep(std::span<const double> times);

// The unit, in place of seconds, that the median step of successive times is likely to have: "microseconds" above a
// thousand, "nanoseconds" above a million; else empty.
std::string_view UnitOfSteps(std::span<const double> times_s);

// Times of successive frames, seconds: finite, growing, told apart by the six decimals that a run writes, and not of
// another unit (UnitOfSteps). `what` begins the sentence ("the times in times.txt are"). Fails with kInvalidArgument.
Status CheckFrameTimes(std::span<const double> times_s, const std::string& what);

// A depth prior of any size, whose sides are to one another as those of the images. `what` begins the sentence. Fails
// with kMismatch.
Status CheckDepthPriorSize(cv::Size prior, cv::Size images, const std::string& what);

}  // namespace pliant
