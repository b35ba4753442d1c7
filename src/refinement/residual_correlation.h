// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How much alike the reprojection errors of neighboring points are (docs/method.md, eq. W11).
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pliant/refinement/refine_recording.h"

namespace pliant {

struct NeighborCorrelation {
  double value = 0;           // from -1 to 1; 0 where no two are neighbors
  double standard_error = 0;  // of the value, where errors are independent
};

// Over the used observations of at most 64 of the views that have any: with the four nearest of the same view that are
// at least `min_distance_px` away.
NeighborCorrelation ResidualCorrelation(const Recording& recording, const std::vector<bool>& used,
                                        const std::vector<Eigen::Vector2d>& errors_px, double min_distance_px);

}  // namespace pliant
