// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Points that slid. Beside an occluding contour a patch shows what is in front as well, and in time its track goes with
// that: the map that is made anew then has the point nearer, though the points around it stay where they were.
#pragma once

#include <vector>

#include "pliant/geometry/rigid3.h"
#include "pliant/scene/map.h"
#include "pliant/tracking/initializer.h"

namespace pliant {

// (docs/method.md, eq. G6) Of the landmarks that two maps had before, made anew like the present one, those whose
// distance from the camera changes otherwise than that of their neighbors: by more than `max_change`, relative, and
// more than three standard deviations of all. `remade` are the present map's points in the world, sorted by id. In
// the order of the landmarks.
std::vector<PointId> SlidPoints(const std::vector<InitPosition>& remade, const Rigid3& cam_from_world, const Map& map,
                                double max_change);

}  // namespace pliant
