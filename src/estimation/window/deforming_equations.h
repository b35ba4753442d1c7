// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The normal equations of a deforming window with the points eliminated (Schur complement): what is left, views,
// coefficients, shapes of the nodes and the light's offset, is small and dense. Scale is free in them; steps and
// variances are those that keep the mean log distance of the gauge's points.
#pragma once

#include <vector>

#include <Eigen/Cholesky>

#include "estimation/window/normal_equations.h"

namespace pliant {

class DeformingEquations final : public NormalEquations {
 public:
  // `gauge`: the points that hold the scale. `threads` never changes the result.
  DeformingEquations(const DeformingTerms& terms, std::vector<int> gauge, int threads = 1);

  bool Linearize(const DeformingState& state) override;
  const Eigen::VectorXd& gradient() const override { return gradient_; }
  Eigen::VectorXd HessianTimes(const Eigen::VectorXd& x) const override;
  Eigen::VectorXd HessianDiagonal() const override { return hessian_.diagonal(); }
  double eliminated_decrease() const override { return eliminated_decrease_; }
  Eigen::VectorXd NewtonStep() const override;
  Eigen::VectorXd WithoutScale(const Eigen::VectorXd& step, const Eigen::VectorXd& metric) const override;
  DeformingState Moved(const DeformingState& state, const Eigen::VectorXd& step) const override;

  // A point's step that goes with one of the rest.
  PointVector PointStep(std::size_t point, const Eigen::VectorXd& step) const;
  // Of the log distances; infinite for a point that nothing determines.
  std::vector<double> Variances() const;

 private:
  Eigen::Index ViewIndex(int view_idx) const { return (view_idx - 1) * terms_->view_size(); }  // negative: not free
  Eigen::Index NodeIndex(Eigen::Index node) const;
  Eigen::Index OffsetIndex() const { return NodeIndex(terms_->num_nodes()); }
  Eigen::Index Size() const { return OffsetIndex() + 1; }

  // What some of the points add.
  struct Sums {
    Eigen::MatrixXd hessian;  // the lower triangle
    Eigen::VectorXd gradient;
    double eliminated_decrease = 0;
  };

  void AddPriors(const DeformingState& state);
  void SumPart(std::size_t part, const DeformingState& state);
  void AddViews(std::size_t point, const std::vector<SeenEquations>& seen, Sums* sums) const;
  void Eliminate(std::size_t point, const PointEquations& own, Sums* sums);
  void SubtractViews(std::size_t point, Sums* sums) const;
  template <int kRank>
  void SubtractViewsOfRank(std::size_t point, Sums* sums) const;
  void AddNodes(std::size_t point, const PointVector& node_difference, Sums* sums) const;
  bool Factorize();
  void AddByPoint(std::size_t point, const PointVector& factor, double scale, Eigen::VectorXd* sum) const;
  PointVector ByRest(std::size_t point, const Eigen::VectorXd& step) const;

  // A point's equations: their inverse, and what couples it to the rest.
  struct Point {
    PointMatrix inverse;  // zero: nothing determines it, it stays where it is
    PointVector gradient;
    std::vector<SeenEquations> seen;
    double by_offset = 0;
  };

  const DeformingTerms* terms_;
  std::vector<int> gauge_;
  int threads_;
  std::vector<Point> points_;
  std::vector<Sums> parts_;
  Eigen::MatrixXd hessian_;  // the lower triangle
  Eigen::VectorXd gradient_;
  Eigen::LLT<Eigen::MatrixXd> factors_;
  double eliminated_decrease_ = 0;
  Eigen::VectorXd scale_;  // what is left of the mean log distance of the gauge's points, by what is left
};

}  // namespace pliant
