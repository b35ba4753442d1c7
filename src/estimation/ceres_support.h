// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the problems over whole views share in their use of Ceres.
#pragma once

#include <Eigen/Geometry>
#include <ceres/problem.h>

namespace pliant {

// A rotation's parameter block: x, y, z, w, as Eigen stores it.
inline Eigen::Quaterniond ReadQuaternion(const double* q) { return Eigen::Quaterniond(q[3], q[0], q[1], q[2]); }

// The problem borrows its losses and manifolds from the caller.
inline ceres::Problem::Options BorrowingOptions() {
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  return options;
}

}  // namespace pliant
