// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Non-linear refinement of the motion between two views, on unit rays; errors in px at the mean focal length
// (docs/method.md, eq. I7).
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
  kNone,     // the pair's motion as the samples gave it
  kOpengv,   // the pair's motion by OpenGV, all inliers alike
  kTwoView,  // the pair's motion by its epipolar errors, robustly
  kWindow,   // kTwoView, then several frames since the reference, their poses and the points together
};

template <>
struct EnumNames<RigidRefinement> {
  static constexpr std::array kNames = {std::pair{RigidRefinement::kNone, std::string_view("none")},
                                        std::pair{RigidRefinement::kOpengv, std::string_view("opengv")},
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

// Minimizes sum rho(SampsonError^2) over the five degrees of freedom, from `start` (|translation| need not be 1).
// Equal to bundle adjustment of both views to first order in the noise. Fails with kInsufficient below six
// correspondences and kDegenerate when Ceres finds no usable step.
Result<TwoViewRefinement> RefineTwoView(const Rigid3& start, std::span<const Eigen::Vector3d> rays0,
                                        std::span<const Eigen::Vector3d> rays1, double focal_px,
                                        const RefinementOptions& options);

// The same by OpenGV's optimize_nonlinear on all correspondences alike, for comparison. It has no robust loss, so it is
// for clean inliers; the options are for the cost and the sigmas alone.
Result<TwoViewRefinement> RefineTwoViewByOpengv(const Rigid3& start, std::span<const Eigen::Vector3d> rays0,
                                                std::span<const Eigen::Vector3d> rays1, double focal_px,
                                                const RefinementOptions& options);

// Cost and sigmas of the motion as it is, but for its length, to compare it with refined ones. Fails with kInsufficient
// below six correspondences.
Result<TwoViewRefinement> AssessTwoView(const Rigid3& cam1_from_cam0, std::span<const Eigen::Vector3d> rays0,
                                        std::span<const Eigen::Vector3d> rays1, double focal_px,
                                        const RefinementOptions& options);

}  // namespace pliant
