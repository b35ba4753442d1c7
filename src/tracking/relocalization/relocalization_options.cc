// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/relocalization_options.h"

namespace pliant {

void RelocalizationOptions::List(OptionTable& table) {
  table.BeginGroup("Relocalization", "the way back after the view was lost");
  table.AddChoice("relocalize", &relocalize,
                  "look for the map's points wherever the camera may be; off: only where it was");
  table.Add("describe_every", &describe_every, "frames", "from one description of the points in view to the next", 1,
            1000000);
  table.Add("search_every", &search_every, "frames", "while another map is awaited, those left are looked for so often",
            1, 1000000);
  table.Add("max_inactive_submaps", &max_inactive_submaps, "-",
            "maps that were left and are remembered; memory grows with them", 1, 1000);
  table.AddChoice("merge", &merge,
                  "maps become one when a map that was left is found in the image of another; needs relocalize, "
                  "find_lost and adaptive patches, and no oracle");
  table.Add("merge_every", &merge_every, "frames",
            "while another map is tracked, one of those left is looked for so often", 1, 1000000);
  table.Add("max_unit_spread", &max_unit_spread, "-",
            "two maps are joined whose points agree on their units: median deviation of the ratio's logarithm", 0, 10);
  table.Add("velocity_frames", &velocity_frames, "frames", "over which the camera's velocity before the loss is taken",
            1, 1000);
  table.Add("max_corners", &max_corners, "-", "of a lost frame, to compare with the map's points", 8, 100000);
  table.Add("max_ratio", &max_ratio, "-", "nearest by second nearest description", 0.1, 1);
  table.Add("max_error_px", &max_error_px, "px", "of a point that agrees with a pose", 0.1, 100);
  table.Add("min_share", &min_share, "-", "of the points that a pose should see: those that agree", 0, 1);
  pose.List(table);
}

}  // namespace pliant
