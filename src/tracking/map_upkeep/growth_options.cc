// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/map_upkeep/growth_options.h"

namespace pliant {

void GrowthOptions::List(OptionTable& table) {
  table.BeginGroup("Growth", "how the map grows and is re-estimated while it is tracked");
  table.AddChoice("grow", &grow, "follow new corners, and add them to the map when their depth is certain");
  table.Add("every", &every, "frames",
            "new corners are detected every Nth frame; every 2Nth while the map has half of Corners.max_corners", 1,
            100000);
  table.Add("min_views", &min_views, "frames",
            "minimum number in which a new point was seen before it can enter the map", 2, 100000);
  table.Add("max_views", &max_views, "frames", "after which a new point is given up whose depth is still uncertain", 2,
            100000);
  table.Add("neighbors", &neighbors, "-",
            "points of the map from which the motion of a new point's surroundings is estimated", 3, 1000);
  table.Add("noise_px", &noise_px, "px", "standard deviation of a new point's pixel, including the error of the poses",
            1e-3, 100);
  table.Add(
      "max_depth_sigma", &max_depth_sigma, "-",
      "a new point enters the map when its distance has at most this standard deviation, relative to the map's median "
      "distance",
      1e-4, 10);
  table.Add("scarce_points", &scarce_points, "-",
            "below this number of points in the map max_depth_sigma is raised, at most three times; 0: never", 0,
            100000);
  table.Add("max_error", &max_error, "-",
            "and when the root mean square of its residuals is at most this, in standard deviations", 1e-3, 1000);
  table.Add("max_error_ratio", &max_error_ratio, "-", "and at most this multiple of the median over the new points", 1,
            1000);
  table.Add("window", &window, "frames", "the map is re-estimated from this many frames and the current one; 0: never",
            0, 1000);
  table.Add(
      "max_measured_share", &max_measured_share, "-",
      "the map is not re-estimated while at least this share of the points in view had their depth measured at the "
      "start (stereo, depth)",
      0.01, 2);
  table.Add("reestimate_every", &reestimate_every, "frames",
            "the map is re-estimated every Nth frame; every 2Nth once half of the points in view were in three "
            "re-estimations",
            1, 100000);
  table.Add(
      "max_depth_change", &max_depth_change, "-",
      "a point of two re-estimations is dropped when another one changes its depth, relative to its neighbors', by "
      "more than this and by more than three standard deviations: it drifted along a contour",
      1e-3, 100);
  table.Add(
      "min_reestimation_weight", &min_reestimation_weight, "-",
      "a point of n re-estimations is moved 1/n of the way to its new position, at least this share; 1: all of it",
      0.01, 1);
  table.Renamed("remake_every", "reestimate_every");
  table.Renamed("remade_weight", "min_reestimation_weight");
}

}  // namespace pliant
