// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/relocalization/relocalization_options.h"

namespace pliant {

void RelocalizationOptions::List(OptionTable& table) {
  table.BeginGroup("Relocalization", "finding the camera again after the view was lost");
  table.AddChoice("relocalize", &relocalize,
                  "search the map's points from any camera pose; off: only from the last one");
  table.Add("describe_every", &describe_every, "frames",
            "descriptors of the points in view are computed every Nth frame", 1, 1000000);
  table.Add("search_every", &search_every, "frames",
            "inactive submaps are searched every Nth frame while a new one is awaited", 1, 1000000);
  table.Add("max_inactive_submaps", &max_inactive_submaps, "-",
            "maximum number of inactive submaps that are kept; memory grows with them", 1, 1000);
  table.AddChoice("merge", &merge,
                  "merge two submaps when an inactive one is found in an image of the current one; needs relocalize, "
                  "find_lost and adaptive patches, and no oracle");
  table.Add("merge_every", &merge_every, "frames",
            "one of the inactive submaps is searched every Nth frame while another one is tracked", 1, 1000000);
  table.Add(
      "max_unit_spread", &max_unit_spread, "-",
      "submaps are merged when the median deviation of the logarithm of their points' depth ratio is at most this", 0,
      10);
  table.Add("velocity_frames", &velocity_frames, "frames",
            "from which the camera's velocity before the loss is estimated", 1, 1000);
  table.Add("max_corners", &max_corners, "-", "of a lost frame that are matched with the map's points", 8, 100000);
  table.Add("max_ratio", &max_ratio, "-",
            "distance to the nearest divided by that to the second nearest descriptor (Lowe's ratio test)", 0.1, 1);
  table.Add("max_error_px", &max_error_px, "px", "reprojection error of an inlier", 0.1, 100);
  table.Add("min_share", &min_share, "-", "minimum share of inliers among the points that the pose should see", 0, 1);
  table.Renamed("remember_every", "describe_every");
  table.Renamed("seek_every", "search_every");
  table.Renamed("max_left", "max_inactive_submaps");
  table.Renamed("join", "merge");
  table.Renamed("join_every", "merge_every");
  pose.List(table);
}

}  // namespace pliant
