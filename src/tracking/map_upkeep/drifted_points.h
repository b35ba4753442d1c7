// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Points that drifted along a contour. Beside an occluding contour a patch shows what is in front as well, and in time
// its track goes with that: the re-estimated map then has the point nearer, though the points around it stay where they
// were.
#pragma once

#include <vector>

#include "pliant/geometry/rigid3.h"
#include "pliant/scene/map.h"
#include "pliant/tracking/bootstrapping/initializer.h"

namespace pliant {

// (docs/method.md, eq. G6) Of the landmarks that two re-estimated maps had before, those whose distance from the camera
// changes otherwise than that of their neighbors: by more than `max_change`, relative, and more than three standard
// deviations of all. `reestimated` are the points of the map that was re-estimated now, in the world, sorted by id. In
// the order of the landmarks.
std::vector<PointId> DriftedPoints(const std::vector<InitPosition>& reestimated, const Rigid3& cam_from_world,
                                   const Map& map, double max_change);

}  // namespace pliant
