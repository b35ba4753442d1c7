// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A plane in two views is explained by two motions (Ma, Soatto, Kosecka and Sastry, "An Invitation to 3-D Vision",
// 5.3.3); in a window of few degrees each is a minimum of the cost, and which one is found depends on the start.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pliant/estimation/window/deforming_window.h"

namespace pliant {

// Whether the points are so close to a plane that a scene which deforms hardly tells its two motions apart.
bool NearlyFlat(const std::vector<Eigen::Vector3d>& points_in_world);

// A solved rigid window's views and points as they would be by the other motion from the first view to the last that
// carries the plane nearest to the points: a start for its other minimum. Nothing where there is no other motion.
std::optional<DeformingWindow> OtherPlanarMotion(const DeformingWindow& solved, double focal_px,
                                                 const DeformingWindowOptions& options);

}  // namespace pliant
