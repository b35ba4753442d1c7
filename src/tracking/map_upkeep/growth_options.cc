// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/growth_options.h"

namespace pliant {

void GrowthOptions::List(OptionTable& table) {
  table.BeginGroup("Growth", "how the map grows, and is kept right, while it is tracked");
  table.AddChoice("grow", &grow, "follow new corners, and take them into the map when their depth is certain");
  table.Add("every", &every, "frames",
            "from one look for new corners to the next; twice that while half of Corners.max_corners are there", 1,
            100000);
  table.Add("min_views", &min_views, "frames", "in which a new point must have been seen", 2, 100000);
  table.Add("max_views", &max_views, "frames", "after which a point that is not certain is given up", 2, 100000);
  table.Add("neighbors", &neighbors, "-", "points of the map that say how a new point's surroundings move", 3, 1000);
  table.Add("noise_px", &noise_px, "px", "of a new point's pixel, with what the poses are off", 1e-3, 100);
  table.Add("max_depth_sigma", &max_depth_sigma, "-",
            "a new point is certain whose distance has no larger standard deviation, by the map's median distance",
            1e-4, 10);
  table.Add("scarce_points", &scarce_points, "-",
            "with fewer points in the map max_depth_sigma grows as they become less, up to three times; 0: never", 0,
            100000);
  table.Add("max_error", &max_error, "-", "and whose residuals are no larger, in standard deviations", 1e-3, 1000);
  table.Add("max_error_ratio", &max_error_ratio, "-", "nor larger than the median of such points' by this", 1, 1000);
  table.Add("window", &window, "frames", "the map is made anew of so many and the present one; 0: never", 0, 1000);
  table.Add("max_measured_share", &max_measured_share, "-",
            "while so many of the points in view had their depth measured at the start (stereo, depth), the map is not "
            "made anew",
            0.01, 2);
  table.Add("reestimate_every", &reestimate_every, "frames",
            "from one such attempt to the next; twice that while half of the points in view were in three of them", 1,
            100000);
  table.Add(
      "max_depth_change", &max_depth_change, "-",
      "a point that two of these maps had is dropped when another changes its depth by more than this, relative to "
      "its neighbors', and by more than three standard deviations: it slid along a contour",
      1e-3, 100);
  table.Add("min_reestimation_weight", &min_reestimation_weight, "-",
            "a point that n of these maps had goes 1/n of the way to where another has it, at least this; 1: all of it",
            0.01, 1);
}

}  // namespace pliant
