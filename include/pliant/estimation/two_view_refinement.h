// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Robust non-linear refinement of a rigid start (Ceres): of the motion between two views, and of several views and the
// points together. All on unit rays; errors in px at the mean focal length (docs/method.md, eq. I7, I10).
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

enum class RigidRefinement {
  kNone,     // RANSAC's motion as it is
  kTwoView,  // the pair's motion by its epipolar errors
  kWindow,   // then several frames since the reference, their poses and the points together
};

template <>
struct EnumNames<RigidRefinement> {
  static constexpr std::array kNames = {std::pair{RigidRefinement::kNone, std::string_view("none")},
                                        std::pair{RigidRefinement::kTwoView, std::string_view("two_view")},
                                        std::pair{RigidRefinement::kWindow, std::string_view("window")}};
};

struct RefinementOptions {
  double loss_scale_px = 0.5;  // Cauchy loss: errors well above this are outliers and hardly count
  int max_iterations = 50;
};

struct TwoViewRefinement {
  Rigid3 cam1_from_cam0;  // |translation| = 1
  double cost = 0;        // 0.5 * sum of the robust squared errors, px^2
  double spread_px = 0;   // robust standard deviation of the errors: 1.48 * the median of their sizes
  // Standard deviation of the translation's direction, radians, along its two principal axes (larger first), for errors
  // of spread_px; infinite where the data do not determine it.
  Eigen::Vector2d direction_sigma_rad = Eigen::Vector2d::Zero();
};

// Minimises sum rho(SampsonError^2) over the five degrees of freedom, from `start` (|translation| need not be 1).
// Equal to bundle adjustment of both views to first order in the noise. Fails with kInsufficient below six
// correspondences and kDegenerate when Ceres finds no usable step.
Result<TwoViewRefinement> RefineTwoView(const Rigid3& start, std::span<const Eigen::Vector3d> rays0,
                                        std::span<const Eigen::Vector3d> rays1, double focal_px,
                                        const RefinementOptions& options);

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
