// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A light at the camera as a depth sensor: distance from brightness, corrected for the surface's inclination
// (docs/method.md, eq. W6, W8).
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pliant/deformation/graph.h"

namespace pliant {

inline constexpr int kNormalNeighbors = 12;  // whose plane is the surface

// `log_light` with the cosine between ray and surface put in, which darkens like distance does. Positions are in the
// camera; the surface at a point is the plane of its neighbors, the nearer the more. NaN stays NaN. `neighbors`:
// kNormalNeighbors or more of each.
std::vector<double> CorrectForInclination(const std::vector<Eigen::Vector3d>& positions_in_cam,
                                          const NeighborLists& neighbors, const std::vector<double>& log_light);

// Median absolute deviations from the median, over the lit points that are not far; 0 where fewer than twenty are lit.
struct LightFit {
  double error = 0;   // of log |x| - light
  double spread = 0;  // of log |x| alone: what a light that says nothing leaves
};
LightFit CompareWithLight(const std::vector<Eigen::Vector3d>& positions_in_cam, const std::vector<double>& log_light);
// The same of a cue that says the distance itself, how far it may be.
LightFit CompareWithPrior(const std::vector<Eigen::Vector3d>& positions_in_cam, const std::vector<double>& log_prior);

}  // namespace pliant
