// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A re-estimated map, in the unit of the present one: in the current frame the points of both are as far from the
// camera, in the median (docs/method.md, eq. W13). The last of an outcome's frames is the current one, in which the
// present map has the camera at `cam_from_world`.
#pragma once

#include <optional>
#include <vector>

#include "pliant/geometry/rigid3.h"
#include "pliant/scene/frame_report.h"
#include "pliant/scene/map.h"
#include "pliant/tracking/bootstrapping/initializer.h"

namespace pliant {

// Of the same reference, and of a scene that is rigid: points are put where the outcome has them, and are there at
// rest; those that it does not have stay where the camera sees them. Returns the camera's pose, and appends the points
// with their new undeformed positions; nothing changes when the two have no point in common.
std::optional<Rigid3> ReplaceMap(const InitOutcome& outcome, const Rigid3& cam_from_world, Map* map,
                                 std::vector<RefinedPoint>* refined);

// Of another reference: where the outcome's points are in the current frame, in the map's world, with the camera kept;
// sorted by id. None when fewer than `min_common` are in both.
std::vector<InitPosition> ReestimatedPositions(const InitOutcome& outcome, const Rigid3& cam_from_world, const Map& map,
                                               int min_common = 12);

// (G8) Distances of ReestimatedPositions from the camera: a landmark that `n` re-estimated maps had before is moved 1/n
// of the way from where it is, in log distance, and at least `min_weight` of it.
void AverageWithBefore(const Rigid3& cam_from_world, const Map& map, double min_weight,
                       std::vector<InitPosition>* reestimated);

}  // namespace pliant
