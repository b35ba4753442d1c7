// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Bundle adjustment of a rigid window: several views and the points together, robustly, on unit rays; errors in px at
// the mean focal length (docs/method.md, eq. I10).
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/status.h"
#include "pliant/estimation/two_view/two_view_refinement.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

// Which of `frames` frames are a window's views: at most `max_views`, which is 2 or more, spread evenly from the first
// frame to the last; ascending.
std::vector<std::size_t> SpreadViews(std::size_t frames, std::size_t max_views);

// One ray of a window: which view, which point, and the unit ray in that view's camera.
struct WindowObservation {
  int view_idx = 0;
  int point_idx = 0;
  Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();
};

struct Window {
  std::vector<Rigid3> cams_from_world;           // view 0 is the reference: the identity, and it stays so
  std::vector<Eigen::Vector3d> points_in_world;  // in front of every camera that sees them
  std::vector<WindowObservation> observations;   // sorted by point, then view
};

struct WindowRefinement {
  Window window;               // refined; the distance between the first and the last view is kept
  double cost = 0;             // 0.5 * sum of the robust squared errors, px^2
  double median_error_px = 0;  // of one observation
  bool converged = false;
};

enum class WindowPoints { kRefined, kFixed };

// Bundle adjustment of a rigid window: every pose but the first, and every point (or the poses alone with
// WindowPoints::kFixed), with a Cauchy loss on each observation. The reference's own rays are measurements like any
// other: a patch's first position has noise too. Fails with kInvalidArgument for indices out of range or a point behind
// a camera that sees it, with kInsufficient below two views or six points, kDegenerate when there is no usable step.
Result<WindowRefinement> RefineWindow(const Window& start, double focal_px, WindowPoints points,
                                      const RefinementOptions& options);

}  // namespace pliant
