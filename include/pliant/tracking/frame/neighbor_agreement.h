// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Does a point move as the points around it do? Material points close to each other deform alike (assumption 2 of the
// method); a track on an occluding contour, a highlight or a tool slides over the surface and moves alone. The joint
// problem cannot see it: one pixel weighs there as much as millimeters of deformation, so the point simply follows its
// wrong track. Here its motion is compared with what its neighbors' motion predicts (docs/method.md, eq. A1-A3).
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/options.h"

namespace pliant {

struct AgreementOptions {
  double max_disagreement_px = 3.0;
  double max_disagreement_sigmas = 4.0;
  int min_neighbors = 6;

  void List(OptionTable& table);  // appended to the group that is open
};

// One point's motion from an anchor (where it was at some earlier time) to now.
struct NeighborMotion {
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();    // world, map units
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // world, map units
};

struct Disagreement {
  double distance_mm = 0;  // between the point and where its neighbors' motion puts it, across the viewing ray
  double sigma_mm = 0;     // robust spread of the same quantity among the neighbors
  int neighbors = 0;       // how many of them were used; 0: no statement
};

// For each point: an affine motion is fitted to its neighbors' (A1; robustly: Tukey weights about the neighbors'
// median motion), evaluated at the point's anchor, and compared with the point's own position (A2), across the ray from
// `camera_center` only, because one view does not observe depth. `neighbors[i]` lists indices into `motions`.
std::vector<Disagreement> MeasureDisagreement(std::span<const NeighborMotion> motions,
                                              std::span<const std::vector<int>> neighbors,
                                              const Eigen::Vector3d& camera_center, int threads);

// Whether the disagreement is a contradiction (A3): larger than both `max_disagreement_px` at this depth and
// `max_disagreement_sigmas` spreads of the neighbors' own. `px_per_mm` = focal length / depth.
bool Contradicts(const Disagreement& disagreement, double px_per_mm, const AgreementOptions& options);

}  // namespace pliant
