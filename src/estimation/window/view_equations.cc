// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/window/view_equations.h"

#include "pliant/base/parallel.h"

namespace pliant {

ViewEquations::ViewEquations(const DeformingTerms& terms, int threads)
    : terms_(&terms), threads_(threads), parts_(kEquationParts) {}

bool ViewEquations::Linearize(const DeformingState& state) {
  ParallelFor(
      static_cast<int>(kEquationParts), threads_, [&](int part) { SumPart(static_cast<std::size_t>(part), state); }, 1);
  Assemble(state);
  const Eigen::VectorXd diagonal = hessian_.diagonal();
  return WithRidge([&](double factor) {
    hessian_.diagonal() = factor * diagonal;
    factors_.compute(hessian_);
    return factors_.info() == Eigen::Success;
  });
}

void ViewEquations::SumPart(std::size_t part, const DeformingState& state) {
  const Eigen::Index size = terms_->view_size();
  const Eigen::Index views = terms_->num_views() - 1;
  Sums& sums = parts_[part];
  sums.hessian.assign(static_cast<std::size_t>(views), ViewMatrix::Zero(size, size));
  sums.gradient.setZero(views * size);
  const std::size_t count = terms_->num_points();
  std::vector<SeenEquations> seen;
  for (std::size_t i = part * count / kEquationParts; i < (part + 1) * count / kEquationParts; ++i) {
    terms_->LinearizeViews(i, state, &seen);
    for (std::size_t k = 0; k < seen.size(); ++k) {
      const int view = terms_->seen(i)[k].view_idx - 1;
      if (view < 0) continue;
      sums.hessian[static_cast<std::size_t>(view)].noalias() +=
          seen[k].by_view.transpose().lazyProduct(seen[k].by_view);
      sums.gradient.segment(view * size, size).noalias() += seen[k].by_view.transpose().lazyProduct(seen[k].error);
    }
  }
}

// The parts' sums and the coefficients' prior (W5).
void ViewEquations::Assemble(const DeformingState& state) {
  const Eigen::Index size = terms_->view_size();
  const Eigen::Index rank = terms_->rank();
  const Eigen::MatrixXd& of_coefficients = terms_->coefficient_hessian();
  const Eigen::Index views = terms_->num_views() - 1;
  gradient_.setZero(views * size);
  entries_.clear();
  const auto enter = [&](Eigen::Index row, Eigen::Index col, double value) {
    entries_.emplace_back(static_cast<int>(row), static_cast<int>(col), value);
  };
  for (const Sums& part : parts_) {
    gradient_ += part.gradient;
    for (Eigen::Index v = 0; v < views; ++v)
      for (Eigen::Index col = 0; col < size; ++col)
        for (Eigen::Index row = col; row < size; ++row)
          enter(v * size + row, v * size + col, part.hessian[static_cast<std::size_t>(v)](row, col));
  }
  if (!terms_->camera_translates())  // nothing else is in their rows: their step is zero
    for (Eigen::Index v = 0; v < views; ++v)
      for (Eigen::Index k = 3; k < 6; ++k) enter(v * size + k, v * size + k, 1.0);
  if (rank > 0) {
    const Eigen::MatrixXd coefficient_gradient = state.coefficients.rightCols(views) * of_coefficients;
    for (Eigen::Index a = 0; a < views; ++a) {
      gradient_.segment(a * size + 6, rank) += coefficient_gradient.col(a);
      for (Eigen::Index b = 0; b <= a; ++b) {
        if (of_coefficients(a, b) == 0.0) continue;
        for (Eigen::Index r = 0; r < rank; ++r) enter(a * size + 6 + r, b * size + 6 + r, of_coefficients(a, b));
      }
    }
  }
  hessian_.resize(views * size, views * size);
  hessian_.setFromTriplets(entries_.begin(), entries_.end());
}

Eigen::VectorXd ViewEquations::HessianTimes(const Eigen::VectorXd& x) const {
  return hessian_.selfadjointView<Eigen::Lower>() * x;
}

DeformingState ViewEquations::Moved(const DeformingState& state, const Eigen::VectorXd& step) const {
  DeformingState moved = state;
  MoveViews(step, &moved);
  return moved;
}

}  // namespace pliant
