// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The first map from one moving camera, the scene taken as rigid over a few frames (Gomez Rodriguez et al., IROS 2022).
//   paper  k frames after the reference, whatever the motion: RANSAC essential matrix, the smaller rotation, cheirality
//          vote, IDWM triangulation with its cheirality test.
//   gated  waits until the pair can carry a map: a rotation does not explain it, no second motion explains it as well
//          (a plane has one), parallax and predicted depth accuracy suffice; then refines robustly over some of the
//          frames since the reference, and leaves out points whose depth is uncertain or which contradict the map.
// The map is scaled once, so that its median depth is nominal_depth_mm. Equations: docs/method.md, eq. I1 to I12.
#pragma once

#include <memory>

#include "pliant/base/options.h"
#include "pliant/base/random.h"
#include "pliant/estimation/relative_pose.h"
#include "pliant/estimation/two_view_refinement.h"
#include "pliant/geometry/triangulation.h"
#include "pliant/tracking/initializer.h"

namespace pliant {

enum class MonocularGates { kGated, kPaper };

struct MonocularInitOptions {
  RelativePoseSolver solver = RelativePoseSolver::kNister;
  RobustLoop robust = RobustLoop::kRansac;
  RigidRefinement refinement = RigidRefinement::kWindow;  // gated only
  TriangulationMethod triangulation = TriangulationMethod::kIdwm;

  // Both.
  double nominal_depth_mm = 50.0;
  double max_error_px = 1.5;
  int max_iterations = 300;
  // Paper: k.
  int paper_frames = 3;

  // Gated: the pair, and the map.
  int min_points = 40;
  double min_parallax_deg = 2.5;
  double max_rotation_share = 0.8;
  double min_inlier_share = 0.5;
  double min_rival_cost_ratio = 1.3;
  double max_median_depth_sigma = 0.03;
  // Gated: one point.
  double sigma_px = 0.5;
  double max_depth_sigma = 0.05;
  // Gated: how long one reference serves.
  int max_window = 60;
  double min_kept_share = 0.4;
  // Gated: the window's refinement.
  int window_frames = 8;

  void List(OptionTable& table);  // appended to the group "Init"
};

// `random` decides RANSAC's samples; every attempt starts from it anew, so that an outcome depends on the input alone.
std::unique_ptr<Initializer> MakeMonocularInitializer(const MonocularInitOptions& options, MonocularGates gates,
                                                      Random random);

}  // namespace pliant
