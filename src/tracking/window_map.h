// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The first map from a solved window: which of its points are certain, and where they were in every frame.
#pragma once

#include "pliant/base/status.h"
#include "pliant/tracking/initializer.h"
#include "pliant/tracking/window_initializer.h"
#include "tracking/window_solution.h"

namespace pliant {

// Whether to wait while many points are uncertain.
enum class WhenUncertain { kWait, kTakeTheCertain };

// By what a point is certain: the solution's prediction, and whether two samples of the points agree on it.
enum class Certainty { kPredictedAndAgreed, kPredicted };

// Fills the outcome in as a map of the whole input, scaled to the nominal depth. What is missing for one else: then
// only the outcome's measurements are filled in.
Status MakeWindowMap(const InitInput& input, const SolvedWindow& window, Certainty certainty,
                     WhenUncertain when_uncertain, const WindowInitOptions& options, double nominal_depth_mm,
                     InitOutcome* outcome);

}  // namespace pliant
