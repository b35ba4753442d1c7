// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/window/deforming_terms.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

// Points nearer to each other than this share of the median distance are compared as if they were this far apart.
constexpr double kMinSpacing = 0.04;
// Without light, a prior this weak keeps the depth of a point that nothing determines from running away.
constexpr double kFarSigma = 100.0;
constexpr double kLightLoss = 1.5;  // in standard deviations

// Cauchy's loss of a squared error in units of its scale, of unit second derivative at zero, and its derivative.
double CauchyLoss(double squared) { return std::log1p(squared); }
double LossWeight(double squared) { return 1.0 / (1.0 + squared); }

// The light's error in standard deviations: its share of the cost, and its weight in the equations.
double LightLoss(double error) { return kLightLoss * kLightLoss * CauchyLoss(std::pow(error / kLightLoss, 2)); }
double LightWeight(double error) { return LossWeight(std::pow(error / kLightLoss, 2)); }

}  // namespace

void MoveViews(const Eigen::VectorXd& step, DeformingState* state) {
  const Eigen::Index rank = state->coefficients.rows();
  Eigen::Index index = 0;
  for (std::size_t v = 1; v < state->poses.size(); ++v) {
    ViewPose& pose = state->poses[v];
    pose.rotation = RotationExp(step.segment<3>(index)).toRotationMatrix() * pose.rotation;
    pose.translation += step.segment<3>(index + 3);
    if (rank > 0) state->coefficients.col(static_cast<Eigen::Index>(v)) += step.segment(index + 6, rank);
    index += 6 + rank;
  }
}

DeformingTerms::DeformingTerms(const DeformingWindow& start, const SurfaceNodes& nodes, double focal_px,
                               const DeformingWindowOptions& options)
    : start_(start),
      options_(options),
      rank_(static_cast<int>(start.coefficients.rows())),
      scale_(focal_px / options.loss_scale_px),
      median_distance_(start.MedianDistance()) {
  for (const Eigen::Vector3d& position : start_.points_in_world)
    charts_.push_back(PointChart::Across(position.normalized()));
  PrepareObservations();
  PrepareNodes(nodes);
  PrepareCoefficients();
  PrepareLight();
}

void DeformingTerms::PrepareObservations() {
  seen_.resize(start_.points_in_world.size());
  for (const DeformingObservation& observation : start_.observations) {
    const Eigen::Vector3d x = start_.cams_from_world[static_cast<std::size_t>(observation.view_idx)] *
                              start_.Position(observation.point_idx, observation.view_idx);
    // Without a point in front the residual is undefined.
    if (x.dot(observation.ray) > 0.0)
      seen_[static_cast<std::size_t>(observation.point_idx)].push_back(
          {observation.view_idx, observation.ray, BasisAcross(observation.ray)});
    else
      ++unmeasured_;
  }
  for (std::vector<Seen>& seen : seen_)
    std::stable_sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) { return a.view_idx < b.view_idx; });
}

void DeformingTerms::PrepareNodes(const SurfaceNodes& nodes) {
  if (rank_ == 0) return;
  node_shapes_ = nodes.shapes;
  around_ = NodesAround(start_.points_in_world, nodes.positions);
  const auto information = [&](double distance) {
    return 1.0 / std::pow(options_.gradient_sigma * std::max(distance, kMinSpacing * median_distance_), 2);
  };
  for (const NodesOfPoint& around : around_) node_information_.push_back(information(around.distance));
  // A node stands for the points around it.
  const auto count = static_cast<Eigen::Index>(nodes.positions.size());
  const double share = static_cast<double>(charts_.size()) / static_cast<double>(count);
  const double of_size = 1.0 / std::pow(options_.shape_sigma * median_distance_, 2);
  node_hessian_ = share * of_size * Eigen::MatrixXd::Identity(count, count);
  const NeighborLists neighbors = NearestNeighbors(nodes.positions, options_.neighbors);
  for (std::size_t i = 0; i < nodes.positions.size(); ++i)
    for (const int j : neighbors[i]) {
      const auto a = static_cast<Eigen::Index>(i);
      const double of_edge = share / options_.neighbors *
                             information((nodes.positions[static_cast<std::size_t>(j)] - nodes.positions[i]).norm());
      node_hessian_(a, a) += of_edge;
      node_hessian_(j, j) += of_edge;
      node_hessian_(a, j) -= of_edge;
      node_hessian_(j, a) -= of_edge;
    }
}

void DeformingTerms::PrepareCoefficients() {
  const Eigen::Index views = num_views();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(std::max<Eigen::Index>(0, views - 2), views);
  for (Eigen::Index v = 1; v + 1 < views; ++v) {
    // The second derivative by divided differences.
    const auto k = static_cast<std::size_t>(v);
    const double before = start_.times[k] - start_.times[k - 1];
    const double after = start_.times[k + 1] - start_.times[k];
    const double first = 2.0 / (before * (before + after)) / options_.acceleration_sigma;
    const double last = 2.0 / (after * (before + after)) / options_.acceleration_sigma;
    rows.row(v - 1).segment<3>(v - 1) << first, -first - last, last;
  }
  const Eigen::MatrixXd hessian = rows.transpose() * rows + Eigen::MatrixXd::Identity(views, views);
  coefficient_hessian_ = hessian.bottomRightCorner(views - 1, views - 1);  // the first view's coefficients are zero
}

void DeformingTerms::PrepareLight() {
  std::vector<double> light(charts_.size(), std::numeric_limits<double>::quiet_NaN());
  for (const DeformingObservation& observation : start_.observations)
    if (observation.view_idx == 0) light[static_cast<std::size_t>(observation.point_idx)] = observation.log_cue;
  if (start_.cue == DistanceCue::kLight)
    light = CorrectForInclination(start_.points_in_world, NearestNeighbors(start_.points_in_world, kNormalNeighbors),
                                  light);
  const auto log_distance = [&](std::size_t i) { return std::log(start_.points_in_world[i].norm()); };
  std::vector<double> offsets;
  for (std::size_t i = 0; i < light.size(); ++i)
    if (std::isfinite(light[i])) offsets.push_back(log_distance(i) - light[i]);
  light_offset_ = offsets.empty() ? std::log(median_distance_) : Median(std::move(offsets));
  for (std::size_t i = 0; i < light.size(); ++i) {
    const bool lit = std::isfinite(light[i]);
    lights_.push_back({lit ? light[i] : log_distance(i) - light_offset_, lit ? options_.light_sigma : kFarSigma, lit});
  }
}

double DeformingTerms::unmeasured_cost() const {
  return 0.5 * unmeasured_ *
         CauchyLoss(std::pow(0.5 * std::numbers::pi * scale_, 2));  // each as if off by a right angle
}

DeformingState DeformingTerms::Start() const {
  DeformingState state{{}, start_.coefficients, {}, node_shapes_, light_offset_};
  for (const Rigid3& pose : start_.cams_from_world) state.poses.push_back({pose.RotationMatrix(), pose.translation});
  state.points.resize(point_size(), static_cast<Eigen::Index>(charts_.size()));
  for (std::size_t i = 0; i < charts_.size(); ++i) {
    auto column = state.points.col(static_cast<Eigen::Index>(i));
    column.head<3>() = charts_[i].Parameters(start_.points_in_world[i]);
    if (rank_ > 0) column.tail(shapes_size()) = start_.shapes[i].reshaped();
  }
  return state;
}

DeformingWindow DeformingTerms::Window(const DeformingState& state) const {
  DeformingWindow window = start_;
  for (std::size_t v = 0; v < state.poses.size(); ++v)
    window.cams_from_world[v] = Rigid3(state.poses[v].rotation, state.poses[v].translation);
  window.coefficients = state.coefficients;
  for (std::size_t i = 0; i < charts_.size(); ++i) {
    const auto column = state.points.col(static_cast<Eigen::Index>(i));
    window.points_in_world[i] = charts_[i].Point(column.head<3>());
    if (rank_ > 0) window.shapes[i] = column.tail(shapes_size()).reshaped(3, rank_);
  }
  return window;
}

Eigen::Vector3d DeformingTerms::Position(std::size_t point, int view_idx, const Eigen::Vector3d& rest,
                                         const DeformingState& state) const {
  Eigen::Vector3d position = rest;
  const auto shapes = state.points.col(static_cast<Eigen::Index>(point)).tail(shapes_size());
  for (int r = 0; r < rank_; ++r) position += state.coefficients(r, view_idx) * shapes.segment<3>(3 * r);
  return position;
}

PointVector DeformingTerms::NodeDifference(std::size_t point, const DeformingState& state) const {
  PointVector difference = state.points.col(static_cast<Eigen::Index>(point)).tail(shapes_size());
  for (const NodeWeight& node : nodes(point)) difference -= node.weight * state.node_shapes.col(node.node_idx);
  return difference;
}

std::optional<double> DeformingTerms::PointCost(std::size_t point, const DeformingState& state) const {
  const auto column = state.points.col(static_cast<Eigen::Index>(point));
  const Eigen::Vector3d rest = charts_[point].Point(column.head<3>());
  double twice = 0;
  for (const Seen& seen : seen_[point]) {
    const ViewPose& pose = state.poses[static_cast<std::size_t>(seen.view_idx)];
    const Eigen::Vector3d x = pose.rotation * Position(point, seen.view_idx, rest, state) + pose.translation;
    if (!(x.dot(seen.ray) > 0.0)) return std::nullopt;
    twice += CauchyLoss(scale_ * scale_ * (seen.basis * x).squaredNorm() / x.squaredNorm());
  }
  const Light& light = lights_[point];
  const double error = (column[2] - light.log_distance - state.light_offset) / light.sigma;
  twice += light.lit ? LightLoss(error) : error * error;
  if (rank_ > 0) twice += node_information_[point] * NodeDifference(point, state).squaredNorm();
  if (!std::isfinite(twice)) return std::nullopt;
  return 0.5 * twice;
}

std::optional<double> DeformingTerms::Cost(const DeformingState& state) const {
  double cost = 0;
  for (std::size_t i = 0; i < charts_.size(); ++i) {
    const auto of_point = PointCost(i, state);
    if (!of_point) return std::nullopt;
    cost += *of_point;
  }
  if (rank_ == 0) return cost;
  const auto coefficients = state.coefficients.rightCols(coefficient_hessian_.cols());
  cost += 0.5 * (state.node_shapes * node_hessian_).cwiseProduct(state.node_shapes).sum();
  cost += 0.5 * (coefficients * coefficient_hessian_).cwiseProduct(coefficients).sum();
  return cost;
}

DeformingTerms::Sight DeformingTerms::LinearizedSight(const Seen& seen, std::size_t point, const Eigen::Vector3d& rest,
                                                      const DeformingState& state) const {
  const ViewPose& pose = state.poses[static_cast<std::size_t>(seen.view_idx)];
  Sight sight;
  sight.turned = pose.rotation * Position(point, seen.view_idx, rest, state);
  const Eigen::Vector3d x = sight.turned + pose.translation;
  const double distance = x.norm();
  sight.error = scale_ / distance * (seen.basis * x);
  const double root = std::sqrt(LossWeight(sight.error.squaredNorm()));
  sight.by_x = root / distance * (scale_ * seen.basis - sight.error * (x / distance).transpose());
  sight.by_position = sight.by_x * pose.rotation;
  sight.error *= root;
  return sight;
}

ViewDerivative DeformingTerms::ByView(const Sight& sight, std::size_t point, const DeformingState& state) const {
  const auto shapes = state.points.col(static_cast<Eigen::Index>(point)).tail(shapes_size());
  ViewDerivative by_view(2, view_size());
  by_view.leftCols<3>().noalias() = sight.by_x * -Skew(sight.turned);
  if (camera_translates())
    by_view.middleCols<3>(3) = sight.by_x;
  else
    by_view.middleCols<3>(3).setZero();
  for (int r = 0; r < rank_; ++r) by_view.col(6 + r).noalias() = sight.by_position * shapes.segment<3>(3 * r);
  return by_view;
}

void DeformingTerms::LinearizeViews(std::size_t point, const DeformingState& state,
                                    std::vector<SeenEquations>* seen) const {
  const Eigen::Vector3d rest = charts_[point].Point(state.points.col(static_cast<Eigen::Index>(point)).head<3>());
  seen->resize(seen_[point].size());
  for (std::size_t k = 0; k < seen->size(); ++k) {
    const Sight sight = LinearizedSight(seen_[point][k], point, rest, state);
    (*seen)[k].error = sight.error;
    (*seen)[k].by_view = ByView(sight, point, state);
  }
}

PointEquations DeformingTerms::Linearized(std::size_t point, const DeformingState& state,
                                          std::vector<SeenEquations>* seen_equations) const {
  const auto column = state.points.col(static_cast<Eigen::Index>(point));
  const Eigen::Vector3d rest = charts_[point].Point(column.head<3>());
  const Eigen::Matrix3d derivative = charts_[point].Derivative(column.head<3>());
  PointEquations equations;
  equations.own.setZero(point_size(), point_size());
  equations.gradient.setZero(point_size());
  if (seen_equations != nullptr) seen_equations->resize(seen_[point].size());
  // Rest position and basis shapes move the point alike, each by its share: the rest position wholly, a basis shape by
  // its coefficient.
  Eigen::Matrix<double, 1 + kMaxWindowRank, 1> shares;
  shares[0] = 1.0;
  for (std::size_t k = 0; k < seen_[point].size(); ++k) {
    const Sight sight = LinearizedSight(seen_[point][k], point, rest, state);
    for (int r = 0; r < rank_; ++r) shares[1 + r] = state.coefficients(r, seen_[point][k].view_idx);
    const Eigen::Matrix3d by_positions = sight.by_position.transpose() * sight.by_position;
    const Eigen::Vector3d gradient = sight.by_position.transpose() * sight.error;
    for (int a = 0; a <= rank_; ++a) {
      equations.gradient.segment<3>(3 * a) += shares[a] * gradient;
      for (int b = 0; b <= a; ++b) equations.own.block<3, 3>(3 * a, 3 * b) += shares[a] * shares[b] * by_positions;
    }
    if (seen_equations == nullptr) continue;
    SeenEquations& of_seen = (*seen_equations)[k];
    of_seen.error = sight.error;
    of_seen.by_view = ByView(sight, point, state);
    of_seen.by_point.resize(2, point_size());
    of_seen.by_point.leftCols<3>().noalias() = sight.by_position * derivative;
    for (int r = 0; r < rank_; ++r) of_seen.by_point.middleCols<3>(3 + 3 * r) = shares[1 + r] * sight.by_position;
  }
  equations.own.leftCols<3>() = (equations.own.leftCols<3>() * derivative).eval();
  equations.own.topLeftCorner<3, 3>() = (derivative.transpose() * equations.own.topLeftCorner<3, 3>()).eval();
  equations.gradient.head<3>() = (derivative.transpose() * equations.gradient.head<3>()).eval();
  equations.own.triangularView<Eigen::StrictlyUpper>() = equations.own.transpose();
  AddLightAndNodes(point, state, &equations);
  return equations;
}

void DeformingTerms::AddLightAndNodes(std::size_t point, const DeformingState& state, PointEquations* equations) const {
  const Light& light = lights_[point];
  const double log_distance = state.points(2, static_cast<Eigen::Index>(point));
  const double error = (log_distance - light.log_distance - state.light_offset) / light.sigma;
  const double weight = (light.lit ? LightWeight(error) : 1.0) / light.sigma;
  equations->own(2, 2) += weight / light.sigma;
  equations->gradient[2] += weight * error;
  equations->by_offset = -weight / light.sigma;
  equations->offset_gradient = -weight * error;
  if (rank_ == 0) return;
  equations->node_difference = NodeDifference(point, state);
  equations->own.diagonal().tail(shapes_size()).array() += node_information_[point];
  equations->gradient.tail(shapes_size()) += node_information_[point] * equations->node_difference;
}

}  // namespace pliant
