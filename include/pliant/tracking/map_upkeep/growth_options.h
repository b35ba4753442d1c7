// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How the map grows, and how it is kept right, while it is tracked.
#pragma once

#include "pliant/base/options.h"

namespace pliant {

struct GrowthOptions {
  Switch grow = Switch::kOn;
  int every = 5;                  // new corners are searched every Nth frame; every 2Nth while half of them are there
  int min_views = 8;              // of a candidate, before it can enter the map
  int max_views = 60;             // a candidate that is no more certain by then is given up
  int neighbors = 8;              // landmarks near it in the image, which say how its surroundings move
  double noise_px = 0.5;          // of a candidate's pixel, with what the poses are off
  double max_depth_sigma = 0.02;  // standard deviation of its distance, by the median of the map
  int scarce_points = 60;         // with fewer in the map max_depth_sigma grows as they become less, up to 3 times
  double max_error = 1.5;         // root mean square of its residuals, in standard deviations
  double max_error_ratio = 2.0;   // the same by its median over the candidates
  int window = 45;                // frames from which the map is re-estimated; 0: never
  int reestimate_every = 20;      // frames; twice that while half of the points in view were in three such maps
  // A point that two re-estimated maps had, and whose depth another one changes by more than its neighbors', has
  // drifted.
  double max_depth_change = 0.02;
  double min_reestimation_weight = 0.3;  // of a re-estimated map against those before it, at least
  // Where this share of the points in view had their depth measured at the start (a pair, a depth image), the map is
  // left as it is.
  double max_measured_share = 0.5;

  void List(OptionTable& table);  // group "Growth"
};

}  // namespace pliant
