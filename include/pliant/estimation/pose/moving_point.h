// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Where a point is that a moving camera has seen from poses that are known, in a scene that deforms meanwhile: it is
// taken to move as its surroundings do, and only what that leaves of its motion in the image is parallax
// (docs/method.md, eq. G3). Frames: world; units: map units.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "pliant/base/status.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

// One view of the point.
struct MovingPointView {
  Rigid3 cam_from_world;
  Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();          // unit, in this camera
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  // since the first view, as the surroundings say
  double displacement_sigma = 0;                           // of its components
};

// What is known of the point's distance besides.
struct DistancePrior {
  double log_distance = 0;  // from the last view's camera
  double sigma = 0;
};

struct MovingPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // in the first view
  double log_distance_sigma = 0;  // predicted standard deviation of the log of its distance from the first camera
  double rms = 0;  // root mean square of its weighted residuals, in standard deviations: about 1, and 2.1 at most
};

// The most likely position by all views, and by `prior` where there is one, Cauchy's loss on each. `start_distance`: a
// guess, from the first camera; `noise_rad`: standard deviation of a ray. Fails with kInsufficient below two views,
// kInvalidArgument for a number that is none, and kDegenerate where nothing bounds the distance or where the point is
// put behind a view.
Result<MovingPoint> TriangulateMovingPoint(std::span<const MovingPointView> views, double start_distance,
                                           double noise_rad, const std::optional<DistancePrior>& prior = {});

}  // namespace pliant
