// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/bootstrapping/make_initializer.h"

namespace pliant {

void MonocularInitOptions::List(OptionTable& table) {
  table.AddChoice("solver", &solver,
                  "gated, paper: solver of the relative pose: OpenGV's essential matrices, OpenCV's MAGSAC, or a "
                  "homography; rotation_only never makes a map");
  table.AddChoice("robust", &robust,
                  "gated, paper: robust estimation around the solver; local: RANSAC with local optimization on the "
                  "inliers");
  table.AddChoice("refinement", &refinement,
                  "gated: refinement of the relative pose: none, the pair (opengv; two_view: with a robust loss), or "
                  "bundle adjustment over window_frames frames");
  table.AddChoice("triangulation", &triangulation, "gated, paper: triangulation of a point from two rays");
  // At least: what is written has six decimals.
  table.Add("nominal_depth_mm", &nominal_depth_mm, "mm", "median depth to which a map of unknown scale is scaled, once",
            0.1, 1e6);
  table.Add("max_error_px", &max_error_px, "px",
            "gated, paper: inlier threshold per view; tight, because deformation looks like noise and grows "
            "with time",
            0.05, 50);
  table.Add("max_iterations", &max_iterations, "-", "gated, paper: maximum number of RANSAC samples of one attempt", 1,
            100000);
  table.Add("min_points", &min_points, "-", "gated, depth_prior: minimum number of points of a map", 12, 100000);
  table.Add("paper_frames", &paper_frames, "frames", "paper: frames between the two views", 1, 1000);
  table.Add("min_parallax_deg", &min_parallax_deg, "deg",
            "gated: minimum median parallax after compensation of the rotation; depth noise is inverse to it", 0.01,
            90);
  table.Add("max_rotation_share", &max_rotation_share, "-",
            "gated: wait while a pure rotation explains a larger share of the points", 0, 1);
  table.Add("min_inlier_share", &min_inlier_share, "-",
            "gated: minimum share of points that agree with one rigid motion", 0, 1);
  table.Add("min_competing_cost_ratio", &min_competing_cost_ratio, "-",
            "gated: minimum cost of a competing motion (a plane has one) divided by the cost of the best motion", 1,
            100);
  table.Renamed("min_rival_cost_ratio", "min_competing_cost_ratio");
  table.Add("max_median_depth_sigma", &max_median_depth_sigma, "-",
            "gated: maximum median of the points' predicted standard deviation of depth divided by depth", 1e-4, 10);
  table.Add("sigma_px", &sigma_px, "px",
            "gated, paper: standard deviation of a tracked pixel, from which depth noise is predicted", 1e-3, 10);
  table.Add("max_depth_sigma", &max_depth_sigma, "-",
            "gated: maximum predicted standard deviation of depth divided by depth, of a point of the map", 1e-4, 10);
  table.Add("max_window", &max_window, "frames",
            "gated: maximum number of frames after the reference; then a new reference is chosen", 1, 100000);
  table.Add("min_kept_share", &min_kept_share, "-",
            "gated: minimum share of the reference's points that are still tracked; below it a new reference is "
            "chosen",
            0, 1);
  table.Add("window_frames", &window_frames, "frames",
            "gated: frames in the bundle adjustment, spread evenly since the reference", 2, 100);
}

void InitOptions::List(OptionTable& table) {
  table.BeginGroup("Init", "the first map");
  table.AddChoice(
      "method", &method,
      "window: all frames since the reference, of a deforming scene; gated: waits until two views "
      "suffice; paper: two views at a fixed distance, as published; stereo: a rectified pair of images; "
      "depth: the sequence's depth image; colmap_model: the points of a COLMAP model; depth_prior: the depth "
      "prior of one image, provisional");
  table.AddChoice("provisional", &window.provisional,
                  "window: maps that are less certain than demanded, where no other comes, or hardly better than one "
                  "constant depth; their frames have the state provisional");
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
    case InitMethod::kDepthPrior:
      return MakePriorInitializer(options.monocular, options.window, options.prior_kind);
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
