// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The map, re-estimated by the deforming window from frames through which its points and others were followed
// (docs/method.md, eq. W13 and G5).
#pragma once

#include "pliant/tracking/bootstrapping/initializer.h"
#include "pliant/tracking/bootstrapping/make_initializer.h"
#include "tracking/bootstrapping/window_solution.h"

namespace pliant {

// From all frames of the input, of which some between the first and the last may be left out. `of_provisional`: in
// place of a provisional map, which another one may replace; one that is certain is only improved by what is certain
// itself. kWait: they make no map that is certain enough; kNewReference: the scene is not of the kind that is asked
// for, or is seen too little.
InitOutcome ReestimateMap(const InitInput& input, WindowScene scene, bool of_provisional,
                          const WindowInitOptions& options, double nominal_depth_mm);

}  // namespace pliant
