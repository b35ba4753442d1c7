// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/tracker_options.h"

namespace pliant {

void TrackerOptions::List(OptionTable& table) {
  corners.List(table);
  masks.List(table);
  point_tracker.List(table);
  init.List(table);
  pose.List(table);
  graph.List(table);
  problem.List(table);
  table.BeginGroup("Tracking", "the tracker: which points stay, when it is lost");
  table.Add("sigma_metric_mm", &sigma_metric_mm, "mm",
            "instead of Deformation.sigma_mm after a start from metric depth, as published", 0.1, 1e6);
  table.AddChoice("neighbor_agreement", &neighbor_agreement, "drop points that move as none of their neighbors does");
  agreement.List(table);
  table.AddChoice(
      "camera_motion", &camera_motion,
      "free: estimated in every frame; none: the camera is known to stand still, all motion is the scene's");
  table.Add(
      "common_motion_share", &common_motion_share, "-",
      "of what all points have done together since they were at rest, this goes to the camera in each frame; 0: none",
      0, 1);
  table.AddChoice("find_lost", &find_lost,
                  "look for points that were lost where the points around them took them; needs adaptive patches");
  table.Add("max_lost_points", &max_lost_points, "-", "lost points that are remembered; memory grows with them", 0,
            1000000);
  table.Add("max_searches", &max_searches, "-", "lost points that are looked for in a frame", 0, 1000000);
  table.Add("max_search_px", &max_search_px, "px",
            "a lost point that is found further from where it is expected is another one", 0, 1000);
  table.Add("max_reprojection_px", &max_reprojection_px, "px",
            "a point further than this from its measurement after the joint problem is dropped", 0.1, 1e6);
  table.Add("min_points", &min_points, "-", "fewer points in a frame: lost", 4, 100000);
  table.Add("min_corners", &min_corners, "-", "fewer corners in an image: it is no reference", 8, 100000);
  table.Add("top_up_frames", &top_up_frames, "frames",
            "while the first map is awaited, corners are added where there are none so often (Init.method = window)", 1,
            1000000);
  table.AddChoice("track_blurred", &track_blurred,
                  "follow the points into blurred images; before the first map pass over these");
  table.Add("min_sharpness", &min_sharpness, "-", "less than this of the last sharp image's: blurred, or dark", 0, 1);
  table.Add("max_blurred_frames", &max_blurred_frames, "frames", "after so many in a row the blur is taken to stay", 0,
            1000000);
  table.Add("max_lost_frames", &max_lost_frames, "frames",
            "lost for so many frames in a row that are not dark, the map is left", 1, 1000000);
  table.AddChoice("submaps", &submaps, "when the map is left begin another one; off: the run ends");
  growth.List(table);
  relocalization.List(table);
  oracle.List(table);
}

}  // namespace pliant
