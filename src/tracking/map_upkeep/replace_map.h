// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A re-estimated map, in the unit of the present one: in the last of its frames the points of both are as far from the
// camera, in the median (docs/method.md, eq. W13). That frame is the current one, or an earlier one where the map was
// re-estimated beside tracking.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "pliant/camera/camera.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/scene/frame_report.h"
#include "pliant/scene/map.h"
#include "pliant/tracking/bootstrapping/initializer.h"
#include "tracking/submap/submap.h"

namespace pliant {

// A map and its camera in one frame.
struct MapInFrame {
  Map map;
  Rigid3 cam_from_world;
};

// Of the same reference, and of a scene that is rigid: the submap is moved into the outcome's world, as the camera of
// `then`, its last frame, says; there points are put where the outcome has them, and are there at rest. Appends all
// points with their undeformed positions. False when the two have no point in common that the map still has: nothing
// changes then.
bool ReplaceMap(const InitOutcome& outcome, const MapInFrame& then, Submap* submap, std::vector<RefinedPoint>* refined);

// Of another reference: where the outcome's points are in its last frame, in the map's world, with the camera kept;
// sorted by id. None when fewer than `min_common` are in both.
std::vector<InitPosition> ReestimatedPositions(const InitOutcome& outcome, const Rigid3& cam_from_world, const Map& map,
                                               int min_common = 12);

// (G9) Re-estimated positions of an earlier frame in the present one: the distance of a landmark changes by as much as
// it did then, and another point is as far away as it was, where `pixel_of` sees it. What became a landmark since is
// left out, as is what is not seen any more.
std::vector<InitPosition> BringForward(const std::vector<InitPosition>& reestimated, const MapInFrame& then,
                                       const Camera& camera, const MapInFrame& now,
                                       const std::function<const Eigen::Vector2d*(PointId)>& pixel_of);

// (G8) Distances of ReestimatedPositions from the camera: a landmark that `n` re-estimated maps had before is moved 1/n
// of the way from where it is, in log distance, and at least `min_weight` of it.
void AverageWithBefore(const Rigid3& cam_from_world, const Map& map, double min_weight,
                       std::vector<InitPosition>* reestimated);

}  // namespace pliant
