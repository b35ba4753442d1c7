// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The answer of an initializer of one's own whose points stand still.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/status.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/tracking/bootstrapping/initializer.h"

namespace pliant {

// World: the camera of the reference, in any unit.
struct RigidMap {
  struct Point {
    PointId id;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    double depth_sigma = 0;  // standard deviation of z; 0: not known
  };
  std::vector<Point> points;  // in any order
  // One a frame of the input; the first is the identity. Those between the first and the last may be left open: they
  // are estimated by the points.
  std::vector<std::optional<Rigid3>> cams_from_world;
};

// Fills the outcome in as a map: scaled so that the median depth is `nominal_depth_mm`, every point in all frames that
// see it, points that are not in it as rejected. Fails with kInvalidArgument for what cannot be meant (numbers that are
// not finite, a point twice or in none of the frames, poses that are missing, a first one that is not the identity),
// with kInsufficient where fewer than `min_points` of the points are seen in the present frame or a frame's pose cannot
// be estimated, and with kDegenerate when the median depth is not positive. The decision is left alone then.
Status FillRigidMap(const InitInput& input, const RigidMap& map, int min_points, double nominal_depth_mm,
                    InitOutcome* outcome);

}  // namespace pliant
