// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A map that was made again, in the unit of the one there is: in the present frame the points of both are as far from
// the camera, in the median (docs/method.md, eq. W13). The last of an outcome's frames is the present one, in which by
// the map the camera is at `cam_from_world`.
#pragma once

#include <optional>
#include <vector>

#include "pliant/geometry/rigid3.h"
#include "pliant/scene/frame_report.h"
#include "pliant/scene/map.h"
#include "pliant/tracking/initializer.h"

namespace pliant {

// Of the same reference, and of a scene that is rigid: points are put where the outcome has them, and are there at
// rest; those that it does not have stay where the camera sees them. Returns the camera's pose, and appends the points
// with their new undeformed positions; nothing happens when the two have no point in common.
std::optional<Rigid3> ReplaceMap(const InitOutcome& outcome, const Rigid3& cam_from_world, Map* map,
                                 std::vector<RefinedPoint>* refined);

// Of another reference: where the outcome's points are in the present frame, in the map's world, the camera being where
// it is; sorted by id. None when fewer than `min_common` are in both.
std::vector<InitPosition> RemadePositions(const InitOutcome& outcome, const Rigid3& cam_from_world, const Map& map,
                                          int min_common = 12);

// (G7) Distances of RemadePositions from the camera: a landmark that `n` maps made anew had before is moved 1/n of the
// way from where it is, in log distance, and at least `least_weight` of it.
void WeighWithBefore(const Rigid3& cam_from_world, const Map& map, double least_weight,
                     std::vector<InitPosition>* remade);

}  // namespace pliant
