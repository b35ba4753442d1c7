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
  table.BeginGroup("Tracking", "the tracker: which points it keeps, when it is lost");
  table.Add("sigma_metric_mm", &sigma_metric_mm, "mm",
            "instead of Deformation.sigma_mm after a start from metric depth, as published", 0.1, 1e6);
  table.AddChoice("neighbor_agreement", &neighbor_agreement, "reject points that do not move like their neighbors");
  agreement.List(table);
  table.AddChoice(
      "camera_motion", &camera_motion,
      "free: estimated in every frame; none: the camera is known to stand still, all motion is the scene's");
  table.Add(
      "common_motion_share", &common_motion_share, "-",
      "share of the rigid motion common to all points since rest that is given to the camera in each frame; 0: none", 0,
      1);
  table.AddChoice("find_lost", &find_lost, "search lost points where their neighbors moved; needs adaptive patches");
  table.Add("max_lost_points", &max_lost_points, "-",
            "maximum number of lost points that are kept; memory grows with them", 0, 1000000);
  table.Add("max_searches", &max_searches, "-", "maximum number of lost points that are searched in a frame", 0,
            1000000);
  table.Add("max_search_px", &max_search_px, "px",
            "a lost point must be found at most this far from where it is expected", 0, 1000);
  table.Add("max_reprojection_px", &max_reprojection_px, "px",
            "a point with a larger reprojection error after the joint problem is rejected", 0.1, 1e6);
  table.Add("min_points", &min_points, "-", "the view is lost with fewer points", 4, 100000);
  table.Add("min_corners", &min_corners, "-",
            "an image with fewer corners is no reference; of tracks from a file 12 are enough", 8, 100000);
  table.Add("top_up_frames", &top_up_frames, "frames",
            "while the first map is awaited, corners are added every Nth frame (Init.method = window)", 1, 1000000);
  table.AddChoice("track_blurred", &track_blurred,
                  "follow the points into blurred images; before the first map such images are skipped");
  table.Add("min_sharpness", &min_sharpness, "-",
            "an image is blurred, or dark, below this share of the last sharp image's sharpness", 0, 1);
  table.Add("max_blurred_frames", &max_blurred_frames, "frames",
            "after this many blurred frames in a row the images are taken as sharp", 0, 1000000);
  table.Add("max_lost_frames", &max_lost_frames, "frames",
            "the map is left after this many lost frames in a row that are not dark", 1, 1000000);
  table.AddChoice("submaps", &submaps, "begin a new submap when the map is left; off: the run ends");
  table.Add(
      "handover_frames", &handover_frames, "frames",
      "first maps and re-estimated maps are computed beside tracking and taken over after this many frames (those "
      "of a rigid scene that are refined: a third); 0: the frame in which a map is due waits for it",
      0, 1000);
  table.AddChoice("handover_waits", &handover_waits,
                  "a frame waits for such a map that is not there in time, so that results do not depend on how fast "
                  "the machine is; off (live input of the newest images): it is taken over when it is there");
  table.Renamed("gauge_share", "common_motion_share");
  growth.List(table);
  relocalization.List(table);
  depth_prior.List(table);
  oracle.List(table);
}

}  // namespace pliant
