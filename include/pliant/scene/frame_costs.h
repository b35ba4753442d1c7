// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The costs of a frame's joint problem, by term.
#pragma once

namespace pliant {

// Costs at the solution by term: 0.5 * lambda * sum of rho.
struct FrameProblemCosts {
  double reprojection = 0;
  double spatial = 0;
  double temporal = 0;
  double edge_length = 0;
  double Total() const { return reprojection + spatial + temporal + edge_length; }
};

}  // namespace pliant
