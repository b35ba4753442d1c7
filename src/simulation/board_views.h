// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// From where a board is photographed for a calibration.
#pragma once

#include <vector>

#include "pliant/base/status.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/simulation/options.h"

namespace pliant::simulation {

// world_from_camera of as many views as the trajectory needs and one more: from all sides, tilted by 5 to 40 degrees,
// the board anywhere in the image and all of it, at least half as wide as the image, in the right image too where there
// is one. Fails as ParseBoard and SimulatedCamera do, and with kInvalidArgument where the scene is no board or the
// camera does not see all of it from anywhere.
Result<std::vector<Rigid3>> BoardViews(const SimulationOptions& options);

}  // namespace pliant::simulation
