// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How certain a solution is (docs/method.md, eq. F9): the covariance of the problem in its Gauss-Newton approximation,
// J^T J inverted. Points are eliminated; of views and nodes, whose covariance would be dense, samples are drawn by
// their sparse Cholesky factor, from which every variance that is asked for follows to 6 %.
#pragma once

#include <vector>

#include "pliant/base/status.h"
#include "pliant/refinement/refine_recording.h"
#include "refinement/bundle.h"
#include "refinement/bundle_problem.h"

namespace pliant {

// Of the problem at its start, which is to be its solution. Fails with kDegenerate where it does not determine its
// variables.
Result<BundleCovariance> ComputeCovariance(const BundleProblem& problem, const Recording& recording);

struct MeasuredResidual {
  double residual = 0;  // of (F7), by the standard deviation of its measurement
  // Of the measurement's variance; the solution has taken up the rest. Sampled: 0 to 1 but for an error of some 0.1.
  double left_share = 1;
};

// (F9) Of the measured distances of such a problem. Fails as the above.
Result<std::vector<MeasuredResidual>> MeasuredResiduals(const BundleProblem& problem);

}  // namespace pliant
