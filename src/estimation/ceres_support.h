// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the problems over whole views share in their use of Ceres.
#pragma once

#include <Eigen/Geometry>
#include <ceres/problem.h>
#include <ceres/solver.h>

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

// How the refinements of rigid views are solved.
inline ceres::Solver::Options RigidSolverOptions(ceres::LinearSolverType linear_solver, int max_iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = linear_solver;
  options.max_num_iterations = max_iterations;
  options.function_tolerance = 1e-10;
  options.parameter_tolerance = 1e-12;
  options.gradient_tolerance = 1e-14;
  options.num_threads = 1;
  options.max_trust_region_radius = 1e8;  // some damping stays, whatever a point's depth does
  options.logging_type = ceres::SILENT;
  return options;
}

}  // namespace pliant
