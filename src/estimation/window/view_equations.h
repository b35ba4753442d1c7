// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The normal equations of a deforming window's views and coefficients, the points fixed. Only coefficients couple
// views, each with the two before it, so they are a narrow band.
#pragma once

#include <vector>

#include <Eigen/SparseCholesky>

#include "estimation/window/normal_equations.h"

namespace pliant {

class ViewEquations final : public NormalEquations {
 public:
  // `threads` never changes the result.
  explicit ViewEquations(const DeformingTerms& terms, int threads = 1);

  bool Linearize(const DeformingState& state) override;
  const Eigen::VectorXd& gradient() const override { return gradient_; }
  Eigen::VectorXd HessianTimes(const Eigen::VectorXd& x) const override;
  Eigen::VectorXd HessianDiagonal() const override { return hessian_.diagonal(); }
  double eliminated_decrease() const override { return 0.0; }
  Eigen::VectorXd NewtonStep() const override { return factors_.solve(-gradient_); }
  Eigen::VectorXd WithoutScale(const Eigen::VectorXd& step, const Eigen::VectorXd&) const override { return step; }
  DeformingState Moved(const DeformingState& state, const Eigen::VectorXd& step) const override;

 private:
  using ViewMatrix = SmallMatrix<Eigen::Dynamic, kMaxViewSize, kMaxViewSize>;
  // What some of the points add: a block a view, but for the first one.
  struct Sums {
    std::vector<ViewMatrix> hessian;
    Eigen::VectorXd gradient;
  };

  void SumPart(std::size_t part, const DeformingState& state);
  void Assemble(const DeformingState& state);

  const DeformingTerms* terms_;
  int threads_;
  std::vector<Sums> parts_;
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::SparseMatrix<double> hessian_;  // the lower triangle
  Eigen::VectorXd gradient_;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>> factors_;
};

}  // namespace pliant
