// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What a rigid window does not know of a deformation: its two halves in time, each solved by itself.
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

}  // namespace pliant
