// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How certain the points of a deforming window are: the inverse of the normal equations at the solution, in which
// poses, courses and modes are free and the priors stand for what is known of them.
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "estimation/deforming_problem.h"

namespace pliant {

std::vector<double> DeformingProblem::LogDepthSigmas() {
  // Depths first: point i's is column 3 i + 2. Then everything else that is free, in an order of our own: Ceres's is
  // that of addresses.
  ceres::Problem::EvaluateOptions options;
  options.num_threads = 1;
  for (Point& point : points_) options.parameter_blocks.push_back(point.parameters.data());
  std::vector<double*> others;
  for (Point& point : points_) others.push_back(point.modes.data());
  for (View& view : views_)
    others.insert(others.end(), {view.rotation.data(), view.translation.data(), view.courses.data()});
  others.push_back(&light_offset_);
  for (double* block : others)
    if (problem_->HasParameterBlock(block) && !problem_->IsParameterBlockConstant(block))
      options.parameter_blocks.push_back(block);

  ceres::CRSMatrix rows;
  std::vector<double> sigmas(points_.size(), std::numeric_limits<double>::infinity());
  if (!problem_->Evaluate(options, nullptr, nullptr, nullptr, &rows)) return sigmas;
  const Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>> jacobian(
      rows.num_rows, rows.num_cols, static_cast<Eigen::Index>(rows.values.size()), rows.rows.data(), rows.cols.data(),
      rows.values.data());
  Eigen::SparseMatrix<double> information = jacobian.transpose() * jacobian;
  constexpr double kLeastInformation = 1e-9;  // of a parameter that nothing speaks of
  for (Eigen::Index k = 0; k < information.cols(); ++k) information.coeffRef(k, k) += kLeastInformation;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(information);
  if (factors.info() != Eigen::Success) return sigmas;
  // With P A P' = L D L' the variance is |D^-1/2 L^-1 P e|^2: the forward half of a solution.
  const Eigen::VectorXd pivots = factors.vectorD();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(information.cols(), static_cast<Eigen::Index>(3 * i + 2));
    const Eigen::VectorXd half = factors.matrixL().solve(Eigen::VectorXd(factors.permutationP() * unit));
    const double variance = half.cwiseAbs2().cwiseQuotient(pivots).sum();
    if (variance > 0.0) sigmas[i] = std::sqrt(variance);
  }
  return sigmas;
}

}  // namespace pliant
