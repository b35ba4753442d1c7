// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/window/deforming_equations.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pliant/base/parallel.h"

namespace pliant {
namespace {

constexpr double kPointRidge = 1e-9;  // relative to the diagonal of a point's own equations

}  // namespace

Eigen::Index DeformingEquations::NodeIndex(Eigen::Index node) const {
  return (terms_->num_views() - 1) * terms_->view_size() + node * terms_->shapes_size();
}

DeformingEquations::DeformingEquations(const DeformingTerms& terms, std::vector<int> gauge, int threads)
    : terms_(&terms),
      gauge_(std::move(gauge)),
      threads_(threads),
      points_(terms.num_points()),
      parts_(kEquationParts) {}

bool DeformingEquations::Linearize(const DeformingState& state) {
  hessian_.setZero(Size(), Size());
  gradient_.setZero(Size());
  eliminated_decrease_ = 0;
  AddPriors(state);
  ParallelFor(
      static_cast<int>(kEquationParts), threads_, [&](int part) { SumPart(static_cast<std::size_t>(part), state); }, 1);
  for (const Sums& part : parts_) {
    hessian_ += part.hessian;
    gradient_ += part.gradient;
    eliminated_decrease_ += part.eliminated_decrease;
  }
  return Factorize();
}

void DeformingEquations::AddPriors(const DeformingState& state) {
  if (!terms_->camera_translates())  // nothing else is in their rows: their step is zero
    for (Eigen::Index v = 1; v < terms_->num_views(); ++v)
      hessian_.diagonal().segment<3>(ViewIndex(static_cast<int>(v)) + 3).setOnes();
  const Eigen::Index rank = terms_->rank();
  if (rank == 0) return;
  const Eigen::MatrixXd& of_coefficients = terms_->coefficient_hessian();
  const Eigen::MatrixXd coefficient_gradient = state.coefficients.rightCols(of_coefficients.cols()) * of_coefficients;
  for (Eigen::Index a = 0; a < of_coefficients.cols(); ++a) {
    const Eigen::Index index = a * terms_->view_size() + 6;
    gradient_.segment(index, rank) += coefficient_gradient.col(a);
    for (Eigen::Index b = 0; b <= a; ++b)
      hessian_.block(index, b * terms_->view_size() + 6, rank, rank).diagonal().array() += of_coefficients(a, b);
  }
  const Eigen::MatrixXd& of_nodes = terms_->node_hessian();
  const Eigen::MatrixXd node_gradient = state.node_shapes * of_nodes;
  const Eigen::Index size = terms_->shapes_size();
  for (Eigen::Index a = 0; a < of_nodes.cols(); ++a) {
    gradient_.segment(NodeIndex(a), size) += node_gradient.col(a);
    for (Eigen::Index b = 0; b <= a; ++b)
      hessian_.block(NodeIndex(a), NodeIndex(b), size, size).diagonal().array() += of_nodes(a, b);
  }
}

void DeformingEquations::SumPart(std::size_t part, const DeformingState& state) {
  Sums& sums = parts_[part];
  sums.hessian.setZero(Size(), Size());
  sums.gradient.setZero(Size());
  sums.eliminated_decrease = 0;
  const std::size_t count = terms_->num_points();
  for (std::size_t i = part * count / kEquationParts; i < (part + 1) * count / kEquationParts; ++i) {
    const PointEquations own = terms_->Linearized(i, state, &points_[i].seen);
    AddViews(i, points_[i].seen, &sums);
    Eliminate(i, own, &sums);
  }
}

void DeformingEquations::AddViews(std::size_t point, const std::vector<SeenEquations>& seen, Sums* sums) const {
  const Eigen::Index size = terms_->view_size();
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const Eigen::Index index = ViewIndex(terms_->seen(point)[k].view_idx);
    if (index < 0) continue;
    sums->hessian.block(index, index, size, size).noalias() += seen[k].by_view.transpose().lazyProduct(seen[k].by_view);
    sums->gradient.segment(index, size).noalias() += seen[k].by_view.transpose().lazyProduct(seen[k].error);
  }
}

void DeformingEquations::Eliminate(std::size_t point, const PointEquations& own, Sums* sums) {
  const Eigen::Index point_size = terms_->point_size();
  Point& of = points_[point];
  PointMatrix damped = own.own;
  damped.diagonal() *= 1.0 + kPointRidge;
  const Eigen::LLT<PointMatrix> factors(damped);
  of.gradient = own.gradient;
  of.by_offset = own.by_offset;
  if (factors.info() != Eigen::Success) {
    of.inverse.setZero(point_size, point_size);
    return;
  }
  of.inverse = factors.solve(PointMatrix::Identity(point_size, point_size));
  const PointVector point_step = of.inverse * of.gradient;
  sums->eliminated_decrease += 0.5 * point_step.dot(of.gradient);
  SubtractViews(point, sums);
  const Eigen::Index offset = OffsetIndex();
  sums->hessian(offset, offset) -= own.by_offset + of.by_offset * of.by_offset * of.inverse(2, 2);
  sums->gradient[offset] += own.offset_gradient;
  if (terms_->shapes_size() > 0) AddNodes(point, own.node_difference, sums);
  AddByPoint(point, point_step, -1.0, &sums->gradient);
}

void DeformingEquations::SubtractViews(std::size_t point, Sums* sums) const {
  static_assert(kMaxWindowRank == 4);
  switch (terms_->rank()) {
    case 0:
      return SubtractViewsOfRank<0>(point, sums);
    case 1:
      return SubtractViewsOfRank<1>(point, sums);
    case 2:
      return SubtractViewsOfRank<2>(point, sums);
    case 3:
      return SubtractViewsOfRank<3>(point, sums);
    default:
      return SubtractViewsOfRank<4>(point, sums);
  }
}

// What is left of the views' equations without the point. What couples a point to a view has two rows, as the
// observation has: these are multiplied. Views are ascending, the first one is not free. Sums are in order, whatever
// the compiler makes of sizes that it knows: a window's solution depends on no machine.
template <int kRank>
void DeformingEquations::SubtractViewsOfRank(std::size_t point, Sums* sums) const {
  constexpr int kViewSize = 6 + kRank;
  constexpr int kShapesSize = 3 * kRank;
  constexpr int kPointSize = 3 + kShapesSize;
  using ByView = Eigen::Map<const Eigen::Matrix<double, 2, kViewSize>>;
  using ByPoint = Eigen::Map<const Eigen::Matrix<double, 2, kPointSize>>;
  using Inverse = Eigen::Map<const Eigen::Matrix<double, kPointSize, kPointSize>>;
  const Eigen::Index offset = OffsetIndex();
  const Point& of = points_[point];
  const Inverse inverse(of.inverse.data());
  for (std::size_t a = 0; a < of.seen.size(); ++a) {
    const Eigen::Index index_a = ViewIndex(terms_->seen(point)[a].view_idx);
    if (index_a < 0) continue;
    const ByPoint a_by_point(of.seen[a].by_point.data());
    const ByView a_by_view(of.seen[a].by_view.data());
    Eigen::Matrix<double, kPointSize, 2> inverse_by_a = Eigen::Matrix<double, kPointSize, 2>::Zero();
    for (int k = 0; k < kPointSize; ++k) inverse_by_a += inverse.col(k) * a_by_point.col(k).transpose();
    for (std::size_t b = 0; b <= a; ++b) {
      const Eigen::Index index_b = ViewIndex(terms_->seen(point)[b].view_idx);
      if (index_b < 0) continue;
      const ByPoint b_by_point(of.seen[b].by_point.data());
      Eigen::Matrix2d between = Eigen::Matrix2d::Zero();
      for (int k = 0; k < kPointSize; ++k) between += inverse_by_a.row(k).transpose() * b_by_point.col(k).transpose();
      const Eigen::Matrix<double, 2, kViewSize> weighted = between.lazyProduct(ByView(of.seen[b].by_view.data()));
      sums->hessian.template block<kViewSize, kViewSize>(index_a, index_b).noalias() -=
          a_by_view.transpose().lazyProduct(weighted);
    }
    sums->hessian.row(offset).template segment<kViewSize>(index_a).noalias() -=
        of.by_offset * inverse_by_a.row(2).lazyProduct(a_by_view);
    if constexpr (kRank > 0) {
      const Eigen::Matrix<double, kShapesSize, kViewSize> shapes_by_a =
          terms_->node_information(point) * inverse_by_a.template bottomRows<kShapesSize>().lazyProduct(a_by_view);
      for (const NodeWeight& node : terms_->nodes(point))
        sums->hessian.template block<kShapesSize, kViewSize>(NodeIndex(node.node_idx), index_a) +=
            node.weight * shapes_by_a;
    }
  }
}

// The equations of the nodes around the point, without the point (W3).
void DeformingEquations::AddNodes(std::size_t point, const PointVector& node_difference, Sums* sums) const {
  const Eigen::Index shapes_size = terms_->shapes_size();
  const Point& of = points_[point];
  const double information = terms_->node_information(point);
  for (const NodeWeight& a : terms_->nodes(point)) {
    const Eigen::Index index = NodeIndex(a.node_idx);
    const double of_a = information * a.weight;
    sums->gradient.segment(index, shapes_size) -= of_a * node_difference;
    for (const NodeWeight& b : terms_->nodes(point)) {
      if (a.node_idx < b.node_idx) continue;
      auto block = sums->hessian.block(index, NodeIndex(b.node_idx), shapes_size, shapes_size);
      block.diagonal().array() += of_a * b.weight;
      block -= of_a * information * b.weight * of.inverse.bottomRightCorner(shapes_size, shapes_size);
    }
    sums->hessian.row(OffsetIndex()).segment(index, shapes_size) +=
        of_a * of.by_offset * of.inverse.row(2).tail(shapes_size);
  }
}

bool DeformingEquations::Factorize() {
  const Eigen::VectorXd diagonal = hessian_.diagonal();
  const bool factorized = WithRidge([&](double factor) {
    hessian_.diagonal() = factor * diagonal;
    factors_.compute(hessian_);
    return factors_.info() == Eigen::Success;
  });
  if (!factorized) return false;
  scale_.setZero(Size());
  for (const int i : gauge_)
    AddByPoint(static_cast<std::size_t>(i), points_[static_cast<std::size_t>(i)].inverse.col(2), 1.0, &scale_);
  return true;
}

// `scale` times a point's share W' x of the equations that are left.
void DeformingEquations::AddByPoint(std::size_t point, const PointVector& factor, double scale,
                                    Eigen::VectorXd* sum) const {
  const Eigen::Index shapes_size = terms_->shapes_size();
  const Point& of = points_[point];
  for (std::size_t k = 0; k < of.seen.size(); ++k) {
    const Eigen::Index index = ViewIndex(terms_->seen(point)[k].view_idx);
    if (index < 0) continue;
    const Eigen::Vector2d seen = scale * of.seen[k].by_point.lazyProduct(factor);
    sum->segment(index, terms_->view_size()).noalias() += of.seen[k].by_view.transpose().lazyProduct(seen);
  }
  if (shapes_size > 0)
    for (const NodeWeight& node : terms_->nodes(point))
      sum->segment(NodeIndex(node.node_idx), shapes_size) -=
          scale * terms_->node_information(point) * node.weight * factor.tail(shapes_size);
  (*sum)[OffsetIndex()] += scale * of.by_offset * factor[2];
}

// W x, of the point's own equations.
PointVector DeformingEquations::ByRest(std::size_t point, const Eigen::VectorXd& step) const {
  const Eigen::Index shapes_size = terms_->shapes_size();
  const Point& of = points_[point];
  PointVector sum = PointVector::Zero(terms_->point_size());
  for (std::size_t k = 0; k < of.seen.size(); ++k) {
    const Eigen::Index index = ViewIndex(terms_->seen(point)[k].view_idx);
    if (index < 0) continue;
    const Eigen::Vector2d seen = of.seen[k].by_view.lazyProduct(step.segment(index, terms_->view_size()));
    sum.noalias() += of.seen[k].by_point.transpose().lazyProduct(seen);
  }
  if (shapes_size > 0)
    for (const NodeWeight& node : terms_->nodes(point))
      sum.tail(shapes_size) -=
          terms_->node_information(point) * node.weight * step.segment(NodeIndex(node.node_idx), shapes_size);
  sum[2] += of.by_offset * step[OffsetIndex()];
  return sum;
}

Eigen::VectorXd DeformingEquations::HessianTimes(const Eigen::VectorXd& x) const {
  return factors_.matrixL() * Eigen::VectorXd(factors_.matrixU() * x);
}

Eigen::VectorXd DeformingEquations::NewtonStep() const {
  Eigen::VectorXd step = factors_.solve(-gradient_);
  if (gauge_.empty()) return step;
  const Eigen::VectorXd by_scale = factors_.solve(scale_);
  return step - scale_.dot(step) / scale_.dot(by_scale) * by_scale;
}

Eigen::VectorXd DeformingEquations::WithoutScale(const Eigen::VectorXd& step, const Eigen::VectorXd& metric) const {
  if (gauge_.empty()) return step;
  const Eigen::VectorXd by_scale = scale_.cwiseQuotient(metric);
  return step - scale_.dot(step) / scale_.dot(by_scale) * by_scale;
}

PointVector DeformingEquations::PointStep(std::size_t point, const Eigen::VectorXd& step) const {
  return points_[point].inverse * (-points_[point].gradient - ByRest(point, step));
}

std::vector<double> DeformingEquations::Variances() const {
  // Of the whole equations' inverse the column of the gauge, by which the free scale is removed.
  const Eigen::VectorXd rest_by_scale = -factors_.solve(scale_);
  Eigen::VectorXd by_scale(static_cast<Eigen::Index>(points_.size()));
  for (std::size_t i = 0; i < points_.size(); ++i)
    by_scale[static_cast<Eigen::Index>(i)] = -points_[i].inverse.row(2) * ByRest(i, rest_by_scale);
  double scale_variance = 0;
  for (const int i : gauge_) {
    by_scale[i] += points_[static_cast<std::size_t>(i)].inverse(2, 2);
    scale_variance += by_scale[i];
  }
  std::vector<double> variances(points_.size());
  ParallelFor(static_cast<int>(points_.size()), threads_, [&](int i) {
    const auto point = static_cast<std::size_t>(i);
    const PointVector own = points_[point].inverse.col(2);
    Eigen::VectorXd half = Eigen::VectorXd::Zero(Size());
    AddByPoint(point, own, 1.0, &half);
    factors_.matrixL().solveInPlace(half);
    double variance = own[2] + half.squaredNorm();
    if (!gauge_.empty()) variance -= std::pow(by_scale[i], 2) / scale_variance;
    variances[point] = own[2] > 0.0 && variance > 0.0 ? variance : std::numeric_limits<double>::infinity();
  });
  return variances;
}

DeformingState DeformingEquations::Moved(const DeformingState& state, const Eigen::VectorXd& step) const {
  DeformingState moved = state;
  MoveViews(step, &moved);
  for (Eigen::Index n = 0; n < moved.node_shapes.cols(); ++n)
    moved.node_shapes.col(n) += step.segment(NodeIndex(n), terms_->shapes_size());
  moved.light_offset += step[OffsetIndex()];
  return moved;
}

}  // namespace pliant
