// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Submaps that meet become one (docs/method.md, eq. R4): an image in which an inactive submap is found, while another
// one is tracked, has a pose in both worlds, and points whose depths tell the one's unit in the other's.
#pragma once

#include <optional>

#include "pliant/geometry/sim3.h"
#include "tracking/submap/submap.h"
#include "tracking/tracks/followed_points.h"

namespace pliant {

// `inactive`: the inactive submap's points that were found in the image in which `current` was tracked, and their
// camera's pose. Nothing where too few pixels tell the unit, or where they differ by more than `max_unit_spread`
// (median deviation of its logarithm).
std::optional<Sim3> InactiveFromCurrent(const FollowedPoints& inactive, const Submap& current, int image_width,
                                        double max_unit_spread);

}  // namespace pliant
