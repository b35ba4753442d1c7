// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What a window does not know of itself: parts of its frames, each solved alone.
#pragma once

#include <vector>

#include "tracking/bootstrapping/window_solution.h"

namespace pliant {

// (W19) For each point of a rigid window of `input`, the largest difference of its log distance in the window's middle
// view between the window, its frames up to there and those from there on, each solved as rigid with `options`, by
// sqrt 2, after one scale each: what errors the scene's deformation makes of depths. Points that are in none of the
// halves get the median. Infinite where a half has no solution.
std::vector<double> SigmasOfHalves(const InitInput& input, const SolvedWindow& rigid, const WindowInitOptions& options,
                                   double nominal_depth_mm);

// (W21) How many times farther the log distances of `ids` in the last view of a window of `input` are from those of its
// later two thirds, solved alone as a deforming scene with `options`, than the sigmas of both say: at least 1, and 1
// where these frames have no solution, or too few of the points.
double SigmaFactorOfLaterPart(const InitInput& input, const SolvedWindow& window, const std::vector<PointId>& ids,
                              const WindowInitOptions& options, double nominal_depth_mm);

}  // namespace pliant
