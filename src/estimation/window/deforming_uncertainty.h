// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How certain a solution of a deforming window is, by itself and compared with others (docs/method.md, eq. W8 to W12).
#pragma once

#include <cstddef>
#include <vector>

#include "estimation/window/deforming_problem.h"
#include "pliant/estimation/window/deforming_window.h"

namespace pliant {

// The problem's present state as a solution, with its light error where there is light, and without sigmas.
DeformingSolution MakeSolution(const DeformingProblem& problem, double cost, const SurfaceNodes& nodes);

// (W9) Whether `a` is the more plausible: minus the log likelihood by images and priors, and by the light, if both have
// it, as one measurement a point of unknown spread.
bool MorePlausible(const DeformingSolution& a, const DeformingSolution& b);

// (W10) One a point, of two samples' solutions, null where a sample has none: then infinite. Empty for one sample.
std::vector<double> SigmasBetween(const std::vector<const DeformingSolution*>& samples, std::size_t points);

// (W12) The pixels' noise as a solution found it: of its own errors, to which it has adapted.
double FoundNoisePx(const DeformingWindow& window, double focal_px);

// (W12) Sigmas of the log distances, of a solution by what it turned out to be: with that noise, and with its own
// shapes' sizes and differences as what was to be expected of them. The scale is held by the first `gauge_points`
// points.
std::vector<double> FoundLogDepthSigmas(const DeformingSolution& solution, double noise_px, std::size_t gauge_points,
                                        double focal_px, const DeformingWindowOptions& options, int threads);

}  // namespace pliant
