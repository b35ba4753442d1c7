// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A solution's terms and its variables, for Ceres.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include <Eigen/Core>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include "pliant/base/status.h"
#include "pliant/residuals/pose_increment.h"
#include "refinement/bundle.h"

namespace pliant {

class BundleProblem {
 public:
  // Both must outlive it; `state` is where it starts and what it solves for.
  BundleProblem(const BundleInput& input, BundleState* state);

  // As SolveBundle.
  Result<BundleSummary> Solve(int max_iterations, const std::function<bool(double)>& callback);

  // The variables, whose values are the start's until Solve. Blocks of views are a pose increment and R temporal
  // coefficients, of points a rest position and R basis shapes, of nodes R basis shapes. The pose of the first view
  // that has terms is held.
  int rank() const { return rank_; }
  ceres::Problem& terms() const { return *problem_; }
  const std::vector<ceres::ResidualBlockId>& measured_distances() const { return measured_distances_; }  // (F7)
  const std::vector<double*>& views() const { return views_; }
  // Whose pose is held: the first one that has terms; null: none has.
  const double* held_view() const { return held_view_; }
  const std::vector<double*>& points() const { return points_; }
  const std::vector<double*>& nodes() const { return nodes_; }
  const std::vector<PoseIncrement>& poses() const { return poses_; }  // of the views

 private:
  void CopyFromState();
  void CopyToState();
  void AddReprojection();
  void AddDistances();
  void AddNodes();
  void AddCoefficients();
  void HoldFirstPose();
  void Hold(const std::vector<double*>& blocks);
  void SetLinearSolver(ceres::Solver::Options* options);

  Eigen::Map<Eigen::VectorXd> Coefficients(std::size_t view) { return {views_[view] + 6, rank_}; }
  Eigen::Map<Eigen::Vector3d> RestPosition(std::size_t point) { return Eigen::Map<Eigen::Vector3d>(points_[point]); }
  Eigen::Map<Eigen::VectorXd> Shapes(double* first) const { return {first, 3 * rank_}; }

  const BundleInput& input_;
  BundleState* state_;
  int rank_;
  std::vector<PoseIncrement> poses_;
  std::vector<double> parameters_;
  std::vector<double*> views_;
  const double* held_view_ = nullptr;
  std::vector<double*> points_;
  std::vector<double*> nodes_;
  std::vector<bool> is_view_in_problem_;
  std::vector<bool> is_point_in_problem_;
  ceres::CauchyLoss loss_;
  std::vector<std::unique_ptr<ceres::ScaledLoss>> losses_;  // a point each
  std::unique_ptr<ceres::Problem> problem_;
  std::vector<ceres::ResidualBlockId> measured_distances_;
};

}  // namespace pliant
