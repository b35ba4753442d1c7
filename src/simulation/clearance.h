// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Whether the camera can go where its path leads.
#pragma once

#include <span>

#include <Eigen/Core>

#include "pliant/base/status.h"
#include "simulation/motion.h"
#include "simulation/ray_scene.h"
#include "simulation/surface.h"
#include "simulation/trajectory.h"

namespace pliant::simulation {

// `tube_mm`: where the tube ends. `first_view`: unit rays of the first camera, in the world.
// Fails with kInvalidArgument where the first camera sees nothing, or the wall's outer side; and, naming the frame,
// where the camera comes to an end of the tube, is nearer to the wall than Trajectory.clearance_mm, or passes through
// it between two frames. Distances are those of the posed triangles; between frames the wall is taken to move evenly.
Status CheckClearance(const SimulationOptions& options, const Path& path, double tube_mm, const Surface& surface,
                      const Motion& motion, const RayScene& at_rest, std::span<const Eigen::Vector3d> first_view);

}  // namespace pliant::simulation
