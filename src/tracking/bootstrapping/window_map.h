// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A map from a solved window: which of its points are certain, and where they were in every frame.
#pragma once

#include "pliant/base/status.h"
#include "pliant/tracking/bootstrapping/initializer.h"
#include "pliant/tracking/bootstrapping/make_initializer.h"
#include "tracking/bootstrapping/window_solution.h"

namespace pliant {

// What a map must be.
struct MapDemands {
  // Of a point by the median depth: at most so much for it to be certain, and to enter the map.
  double certain_sigma = 0;
  double max_sigma = 0;
  double certain_share = 0;  // of the points still seen, at least
  // Points farther than the median are judged by their own depth, and the map by their log depths, which have to stand
  // out as those of a certain map do (kMinDepthSignal).
  bool far_by_own_distance = false;
  // Points whose errors stand out are less certain in proportion, and left out where they do so by three times.
  bool scales_sigmas_with_error = false;
  bool provisional = false;  // less than the options demand
};

// Those of the options: in full, wholly relaxed (1), or between.
MapDemands DemandsOf(const WindowInitOptions& options, double relaxed);

// (W15) Those of a provisional map: most of its points' sigmas are small by the spread of their depths, and small
// enough to be trusted.
MapDemands ProvisionalDemands(const DeformingWindow& window, bool far_by_own_distance);

// How many points a map needs: those of the options, or half of the reference's points where these are few.
int NeededPoints(const InitInput& input, const WindowInitOptions& options);

// Fills the outcome in as a map of the whole input, scaled to the nominal depth. What is missing for one else: then
// only the outcome's measurements are filled in.
Status MakeWindowMap(const InitInput& input, const SolvedWindow& window, const MapDemands& demands,
                     const WindowInitOptions& options, double nominal_depth_mm, InitOutcome* outcome);

}  // namespace pliant
