// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/deforming_equations.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pliant {
namespace {

// Keeps what nothing speaks of from making the equations singular; relative to the diagonal.
constexpr double kLeastRidge = 1e-9;
constexpr double kMostRidge = 1.0;

}  // namespace

Eigen::Index DeformingEquations::NodePlace(Eigen::Index node) const {
  return (terms_->num_views() - 1) * terms_->view_size() + node * terms_->modes_size();
}

std::optional<DeformingEquations> DeformingEquations::At(const DeformingTerms& terms, const DeformingState& state,
                                                         FreeParts free, const std::vector<int>& gauge) {
  DeformingEquations equations(terms, free);
  equations.curvature_.setZero(equations.Size(), equations.Size());
  equations.slope_.setZero(equations.Size());
  equations.AddPriors(state);
  equations.points_.resize(free == FreeParts::kAll ? terms.num_points() : 0);
  std::vector<SeenEquations> seen;
  for (std::size_t i = 0; i < terms.num_points(); ++i) {
    const PointEquations own = terms.Linearised(i, state, &seen);
    equations.AddViews(i, seen);
    if (free == FreeParts::kAll && !equations.Eliminate(i, own, seen)) return std::nullopt;
  }
  if (!equations.Factorise(gauge)) return std::nullopt;
  return equations;
}

void DeformingEquations::AddPriors(const DeformingState& state) {
  const Eigen::Index rank = terms_->rank();
  if (rank == 0) return;
  const Eigen::MatrixXd& courses = terms_->course_form();
  const Eigen::MatrixXd pull = state.courses.rightCols(courses.cols()) * courses;
  for (Eigen::Index a = 0; a < courses.cols(); ++a) {
    const Eigen::Index place = a * terms_->view_size() + 6;
    slope_.segment(place, rank) += pull.col(a);
    for (Eigen::Index b = 0; b <= a; ++b)
      curvature_.block(place, b * terms_->view_size() + 6, rank, rank).diagonal().array() += courses(a, b);
  }
  if (free_ != FreeParts::kAll) return;
  const Eigen::MatrixXd& nodes = terms_->node_form();
  const Eigen::MatrixXd node_pull = state.node_modes * nodes;
  const Eigen::Index size = terms_->modes_size();
  for (Eigen::Index a = 0; a < nodes.cols(); ++a) {
    slope_.segment(NodePlace(a), size) += node_pull.col(a);
    for (Eigen::Index b = 0; b <= a; ++b)
      curvature_.block(NodePlace(a), NodePlace(b), size, size).diagonal().array() += nodes(a, b);
  }
}

void DeformingEquations::AddViews(std::size_t point, const std::vector<SeenEquations>& seen) {
  const Eigen::Index size = terms_->view_size();
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const Eigen::Index place = ViewPlace(terms_->seen(point)[k].view_idx);
    if (place < 0) continue;
    curvature_.block(place, place, size, size).noalias() += seen[k].by_view.transpose().lazyProduct(seen[k].by_view);
    slope_.segment(place, size).noalias() += seen[k].by_view.transpose().lazyProduct(seen[k].error);
  }
}

bool DeformingEquations::Eliminate(std::size_t point, const PointEquations& own,
                                   const std::vector<SeenEquations>& seen) {
  const Eigen::Index view_size = terms_->view_size();
  const Eigen::Index modes_size = terms_->modes_size();
  const Eigen::Index point_size = terms_->point_size();
  Point& of = points_[point];
  PointMatrix damped = own.own;
  damped.diagonal() *= 1.0 + kLeastRidge;
  const Eigen::LLT<PointMatrix> factors(damped);
  if (factors.info() != Eigen::Success) return false;
  of.inverse = factors.solve(PointMatrix::Identity(point_size, point_size));
  of.gradient = own.gradient;
  of.by_offset = own.by_offset;
  const PointVector settled = of.inverse * of.gradient;
  settled_ += 0.5 * settled.dot(of.gradient);

  // Views are ascending, the first one is not free.
  std::vector<Eigen::Index> places;
  of.by_views.resize(point_size, static_cast<Eigen::Index>(seen.size()) * view_size);
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const Eigen::Index place = ViewPlace(terms_->seen(point)[k].view_idx);
    if (place < 0) continue;
    of.by_views.middleCols(static_cast<Eigen::Index>(places.size()) * view_size, view_size).noalias() =
        seen[k].by_point.transpose().lazyProduct(seen[k].by_view);
    places.push_back(place);
  }
  of.by_views.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(places.size()) * view_size);
  const Eigen::MatrixXd weighted = of.inverse * of.by_views;
  Eigen::MatrixXd product(of.by_views.cols(), of.by_views.cols());
  product.triangularView<Eigen::Lower>() = of.by_views.transpose() * weighted;
  for (std::size_t a = 0; a < places.size(); ++a)
    for (std::size_t b = 0; b <= a; ++b)
      curvature_.block(places[a], places[b], view_size, view_size) -= product.block(
          static_cast<Eigen::Index>(a) * view_size, static_cast<Eigen::Index>(b) * view_size, view_size, view_size);

  const Eigen::Index offset = OffsetPlace();
  for (std::size_t k = 0; k < places.size(); ++k)
    curvature_.row(offset).segment(places[k], view_size) -=
        of.by_offset * weighted.row(2).segment(static_cast<Eigen::Index>(k) * view_size, view_size);
  curvature_(offset, offset) -= own.by_offset + of.by_offset * of.by_offset * of.inverse(2, 2);
  slope_[offset] += own.offset_gradient;
  if (modes_size > 0) {
    const double pull = terms_->node_pull(point);
    for (const NodeWeight& a : terms_->nodes(point)) {
      const Eigen::Index place = NodePlace(a.node_idx);
      const double of_a = pull * a.weight;
      slope_.segment(place, modes_size) -= of_a * own.node_difference;
      for (std::size_t k = 0; k < places.size(); ++k)
        curvature_.block(place, places[k], modes_size, view_size) +=
            of_a * weighted.block(3, static_cast<Eigen::Index>(k) * view_size, modes_size, view_size);
      for (const NodeWeight& b : terms_->nodes(point)) {
        if (a.node_idx < b.node_idx) continue;
        auto block = curvature_.block(place, NodePlace(b.node_idx), modes_size, modes_size);
        block.diagonal().array() += of_a * b.weight;
        block -= of_a * pull * b.weight * of.inverse.bottomRightCorner(modes_size, modes_size);
      }
      curvature_.row(offset).segment(place, modes_size) += of_a * of.by_offset * of.inverse.row(2).tail(modes_size);
    }
  }
  slope_ -= ByPoint(point, settled);
  return true;
}

bool DeformingEquations::Factorise(const std::vector<int>& gauge) {
  const Eigen::VectorXd diagonal = curvature_.diagonal();
  for (double ridge = kLeastRidge; ridge < kMostRidge; ridge *= 10.0) {
    curvature_.diagonal() = (1.0 + ridge) * diagonal;
    factors_.compute(curvature_);
    if (factors_.info() == Eigen::Success) break;
  }
  if (factors_.info() != Eigen::Success) return false;
  gauge_ = gauge;
  scale_.setZero(Size());
  for (const int i : gauge_)
    scale_ += ByPoint(static_cast<std::size_t>(i), points_[static_cast<std::size_t>(i)].inverse.col(2));
  return true;
}

// A point's share W' x of the equations that are left, and W x of its own.
Eigen::VectorXd DeformingEquations::ByPoint(std::size_t point, const PointVector& factor) const {
  const Eigen::Index view_size = terms_->view_size();
  const Eigen::Index modes_size = terms_->modes_size();
  const Point& of = points_[point];
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(Size());
  Eigen::Index column = 0;
  for (const DeformingTerms::Seen& seen : terms_->seen(point)) {
    const Eigen::Index place = ViewPlace(seen.view_idx);
    if (place < 0) continue;
    sum.segment(place, view_size).noalias() += of.by_views.middleCols(column, view_size).transpose() * factor;
    column += view_size;
  }
  if (modes_size > 0)
    for (const NodeWeight& node : terms_->nodes(point))
      sum.segment(NodePlace(node.node_idx), modes_size) -=
          terms_->node_pull(point) * node.weight * factor.tail(modes_size);
  sum[OffsetPlace()] += of.by_offset * factor[2];
  return sum;
}

PointVector DeformingEquations::ByRest(std::size_t point, const Eigen::VectorXd& step) const {
  const Eigen::Index view_size = terms_->view_size();
  const Eigen::Index modes_size = terms_->modes_size();
  const Point& of = points_[point];
  PointVector sum = PointVector::Zero(terms_->point_size());
  Eigen::Index column = 0;
  for (const DeformingTerms::Seen& seen : terms_->seen(point)) {
    const Eigen::Index place = ViewPlace(seen.view_idx);
    if (place < 0) continue;
    sum.noalias() += of.by_views.middleCols(column, view_size) * step.segment(place, view_size);
    column += view_size;
  }
  if (modes_size > 0)
    for (const NodeWeight& node : terms_->nodes(point))
      sum.tail(modes_size) -=
          terms_->node_pull(point) * node.weight * step.segment(NodePlace(node.node_idx), modes_size);
  sum[2] += of.by_offset * step[OffsetPlace()];
  return sum;
}

Eigen::VectorXd DeformingEquations::CurvatureTimes(const Eigen::VectorXd& x) const {
  return factors_.matrixL() * Eigen::VectorXd(factors_.matrixU() * x);
}

Eigen::VectorXd DeformingEquations::CurvatureDiagonal() const { return curvature_.diagonal(); }

Eigen::VectorXd DeformingEquations::NewtonStep() const {
  const Eigen::VectorXd step = factors_.solve(-slope_);
  if (gauge_.empty()) return step;
  const Eigen::VectorXd by_scale = factors_.solve(scale_);
  return step - scale_.dot(step) / scale_.dot(by_scale) * by_scale;
}

Eigen::VectorXd DeformingEquations::WithoutScale(const Eigen::VectorXd& step, const Eigen::VectorXd& metric) const {
  if (gauge_.empty()) return step;
  const Eigen::VectorXd by_scale = scale_.cwiseQuotient(metric);
  return step - scale_.dot(step) / scale_.dot(by_scale) * by_scale;
}

Eigen::MatrixXd DeformingEquations::PointSteps(const Eigen::VectorXd& step) const {
  Eigen::MatrixXd steps(terms_->point_size(), static_cast<Eigen::Index>(points_.size()));
  for (std::size_t i = 0; i < points_.size(); ++i)
    steps.col(static_cast<Eigen::Index>(i)) = points_[i].inverse * (-points_[i].gradient - ByRest(i, step));
  return steps;
}

std::vector<double> DeformingEquations::Variances() const {
  // Of the whole equations' inverse the column of the gauge, by which the free scale is taken off.
  const Eigen::VectorXd rest_by_scale = -factors_.solve(scale_);
  Eigen::VectorXd by_scale(static_cast<Eigen::Index>(points_.size()));
  for (std::size_t i = 0; i < points_.size(); ++i)
    by_scale[static_cast<Eigen::Index>(i)] = -points_[i].inverse.row(2) * ByRest(i, rest_by_scale);
  double scale_variance = 0;
  for (const int i : gauge_) {
    by_scale[i] += points_[static_cast<std::size_t>(i)].inverse(2, 2);
    scale_variance += by_scale[i];
  }
  std::vector<double> variances;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const PointVector own = points_[i].inverse.col(2);
    const Eigen::VectorXd half = factors_.matrixL().solve(ByPoint(i, own));
    double variance = own[2] + half.squaredNorm();
    if (!gauge_.empty()) variance -= std::pow(by_scale[static_cast<Eigen::Index>(i)], 2) / scale_variance;
    variances.push_back(variance > 0.0 ? variance : std::numeric_limits<double>::infinity());
  }
  return variances;
}

DeformingState DeformingEquations::Moved(const DeformingState& state, const Eigen::VectorXd& step) const {
  DeformingState moved = state;
  const Eigen::Index rank = terms_->rank();
  for (std::size_t v = 1; v < moved.cams_from_world.size(); ++v) {
    const Eigen::Index place = ViewPlace(static_cast<int>(v));
    Rigid3& pose = moved.cams_from_world[v];
    pose = Rigid3((RotationExp(step.segment<3>(place)) * pose.rotation).normalized(),
                  pose.translation + step.segment<3>(place + 3));
    if (rank > 0) moved.courses.col(static_cast<Eigen::Index>(v)) += step.segment(place + 6, rank);
  }
  if (free_ != FreeParts::kAll) return moved;
  for (Eigen::Index n = 0; n < moved.node_modes.cols(); ++n)
    moved.node_modes.col(n) += step.segment(NodePlace(n), terms_->modes_size());
  moved.light_offset += step[OffsetPlace()];
  return moved;
}

}  // namespace pliant
