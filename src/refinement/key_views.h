// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Views that say enough of a whole recording: where tracks are long, neighboring views say the same of the points.
#pragma once

#include <vector>

#include "pliant/refinement/refine_recording.h"
#include "refinement/bundle.h"

namespace pliant {

// Every so many views the median track (over the observations) has `views_per_track` of them; at least 1.
int StrideOfKeyViews(const Recording& recording, const std::vector<bool>& used, int views_per_track);

// Of the used observations those in every `stride`-th view, that of measured distances among them, of points and views
// with enough of them.
std::vector<bool> UsedInKeyViews(const Recording& recording, const std::vector<bool>& used, int stride);

// Leaves out the observations of points that too few views see, and of views that see too few points, for a part in a
// solution.
void KeepDetermined(const Recording& recording, std::vector<bool>* used);

// Sets poses and coefficients of the views that have no used observation by those before and after them that have: a
// pose moves in the world as `recording` has it moved between these.
void InterpolateViews(const Recording& recording, const std::vector<bool>& used, BundleState* state);

}  // namespace pliant
