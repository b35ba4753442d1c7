// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/make_initializer.h"

namespace pliant {

void MonocularInitOptions::List(OptionTable& table) {
  table.AddChoice("solver", &solver,
                  "gated, paper: the motion of two views. OpenGV's essential matrices, OpenCV's MAGSAC, or a plane's; "
                  "rotation_only never makes a map");
  table.AddChoice("robust", &robust, "gated, paper: how samples make a motion; local: RANSAC that refines on inliers");
  table.AddChoice("refinement", &refinement,
                  "gated: what follows: nothing, the pair alone (by OpenGV; two_view: robustly), or the points with "
                  "window_frames of the frames since");
  table.AddChoice("triangulation", &triangulation, "how a point comes from two rays");
  table.Add("nominal_depth_mm", &nominal_depth_mm, "mm", "the map is scaled once so that this is its median depth",
            1e-3, 1e6);
  table.Add("max_error_px", &max_error_px, "px",
            "inlier threshold per view; tight, because deformation looks like noise and grows with waiting", 0.05, 50);
  table.Add("max_iterations", &max_iterations, "-", "most RANSAC samples of one attempt", 1, 100000);
  table.Add("min_points", &min_points, "-", "gated: fewer points make no map", 12, 100000);
  table.Add("paper_frames", &paper_frames, "frames", "paper: distance of the two frames", 1, 1000);
  table.Add("min_parallax_deg", &min_parallax_deg, "deg",
            "gated: median parallax, the rotation taken off; depth noise falls with its inverse", 0.01, 90);
  table.Add("max_rotation_share", &max_rotation_share, "-",
            "gated: wait while a rotation alone explains more of the points than this", 0, 1);
  table.Add("min_inlier_share", &min_inlier_share, "-", "gated: points that agree with one rigid motion", 0, 1);
  table.Add("min_competing_cost_ratio", &min_competing_cost_ratio, "-",
            "gated: a second motion (a plane has one) must fit worse by this factor", 1, 100);
  table.Add("max_median_depth_sigma", &max_median_depth_sigma, "-",
            "gated: predicted standard deviation of depth by depth, median of the map", 1e-4, 10);
  table.Add("sigma_px", &sigma_px, "px", "standard deviation of a tracked pixel, for all predictions of depth noise",
            1e-3, 10);
  table.Add("max_depth_sigma", &max_depth_sigma, "-",
            "gated: a point with a larger predicted standard deviation of depth by depth stays out", 1e-4, 10);
  table.Add("max_window", &max_window, "frames", "gated: a reference that made no map by then is given up", 1, 100000);
  table.Add("min_kept_share", &min_kept_share, "-",
            "gated: a reference of whose points fewer are still followed is given up", 0, 1);
  table.Add("window_frames", &window_frames, "frames",
            "gated: frames in the window's refinement, spread evenly since the reference", 2, 100);
}

void InitOptions::List(OptionTable& table) {
  table.BeginGroup("Init", "the first map");
  table.AddChoice("method", &method,
                  "window: all frames since the reference, the scene deforming; gated: waits until two views can carry "
                  "a map; paper: 3 frames apart, as published; stereo: a pair of images; depth: the "
                  "sequence's own depth image; colmap_model: the points of a COLMAP model");
  monocular.List(table);
  stereo.List(table);
  depth.List(table);
  model.List(table);
  window.List(table);
}

std::unique_ptr<Initializer> MakeInitializer(const InitOptions& options, Random random) {
  switch (options.method) {
    case InitMethod::kStereo:
      return MakeKnownPointsInitializer(
          {.name = "stereo", .source = "the pair of images", .unit_mm = 1.0, .min_points = options.stereo.min_points},
          options.monocular.nominal_depth_mm);
    case InitMethod::kDepth:
      return MakeDepthInitializer(options.depth);
    case InitMethod::kColmapModel:
      return MakeKnownPointsInitializer({.name = "colmap_model",
                                         .source = "the model",
                                         .unit_mm = options.model.unit_mm,
                                         .min_points = options.model.min_points},
                                        options.monocular.nominal_depth_mm);
    case InitMethod::kPaper:
      return MakePaperInitializer(options.monocular, random);
    case InitMethod::kGated:
      return MakeGatedInitializer(options.monocular, random);
    case InitMethod::kWindow:
      break;
  }
  return MakeWindowInitializer(options.window, options.monocular.nominal_depth_mm);
}

}  // namespace pliant
