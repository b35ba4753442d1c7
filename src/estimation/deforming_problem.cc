// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/deforming_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "estimation/ceres_support.h"
#include "pliant/base/statistics.h"

namespace pliant {
namespace {

// Points nearer to each other than this share of the median distance are compared as if they were this far apart.
constexpr double kLeastSpacing = 0.04;
// The scale is held by some points alone, spread over the nearer ones: a row over all would make the problem dense.
constexpr int kGaugePoints = 32;
constexpr double kGaugeReach = 0.5;  // log distance beyond the median up to which a point may hold the scale
constexpr double kScaleWeight = 300.0;
// Without light, a prior this weak keeps the depth of a point that nothing determines from running away.
constexpr double kFarSigma = 100.0;
constexpr double kLightLoss = 1.5;  // in standard deviations

std::vector<double> Logs(const std::vector<Eigen::Vector3d>& positions) {
  std::vector<double> logs;
  for (const Eigen::Vector3d& position : positions) logs.push_back(std::log(position.norm()));
  return logs;
}

}  // namespace

DeformingProblem::DeformingProblem(const DeformingWindow& start, double focal_px, const DeformingWindowOptions& options)
    : start_(start),
      focal_px_(focal_px),
      options_(options),
      rank_(static_cast<int>(start.courses.rows())),
      cauchy_(options.loss_scale_px),
      loss_(&cauchy_, 1.0 / (options.loss_scale_px * options.loss_scale_px), ceres::DO_NOT_TAKE_OWNERSHIP),
      light_loss_(kLightLoss),
      problem_(std::make_unique<ceres::Problem>(BorrowingOptions())) {
  median_distance_ = std::exp(Median(Logs(start.points_in_world)));
  for (std::size_t v = 0; v < start.cams_from_world.size(); ++v)
    views_.push_back(
        {start.cams_from_world[v].rotation.coeffs(), start.cams_from_world[v].translation,
         rank_ > 0 ? Eigen::VectorXd(start.courses.col(static_cast<Eigen::Index>(v))) : Eigen::VectorXd()});
  for (std::size_t i = 0; i < start.points_in_world.size(); ++i) {
    const Eigen::Vector3d& position = start.points_in_world[i];
    const PointChart chart = PointChart::Across(position.normalized());
    points_.push_back({chart, chart.Parameters(position),
                       rank_ > 0 ? Eigen::VectorXd(start.modes[i].reshaped()) : Eigen::VectorXd()});
  }
  neighbors_ = NearestNeighbors(start.points_in_world, std::max(options_.neighbors, kSlopeNeighbors));
  AddObservations();
  if (rank_ > 0) AddSmoothness();
  AddScale();
  AddLight();
}

double DeformingProblem::EdgeWeight(double distance) const {
  const double spacing = std::max(distance, kLeastSpacing * median_distance_);
  return 1.0 / (options_.gradient_sigma * spacing * std::sqrt(static_cast<double>(options_.neighbors)));
}

void DeformingProblem::AddObservations() {
  for (const DeformingObservation& observation : start_.observations) {
    View& view = views_[static_cast<std::size_t>(observation.view_idx)];
    Point& point = points_[static_cast<std::size_t>(observation.point_idx)];
    // Without a point in front the residual is undefined.
    const Eigen::Vector3d x = start_.cams_from_world[static_cast<std::size_t>(observation.view_idx)] *
                              start_.Position(observation.point_idx, observation.view_idx);
    if (!(x.dot(observation.ray) > 0.0)) {
      ++unmeasured_;
      continue;
    }
    std::vector<double*> blocks = {view.rotation.data(), view.translation.data(), point.parameters.data()};
    if (rank_ > 0) {
      blocks.push_back(view.courses.data());
      blocks.push_back(point.modes.data());
    }
    problem_->AddResidualBlock(new DeformingDirectionCost(point.chart, observation.ray, focal_px_, rank_), &loss_,
                               blocks);
  }
  for (View& view : views_) {
    problem_->AddParameterBlock(view.rotation.data(), 4, &rotation_manifold_);
    problem_->AddParameterBlock(view.translation.data(), 3);
    if (rank_ > 0) problem_->AddParameterBlock(view.courses.data(), rank_);
  }
  problem_->SetParameterBlockConstant(views_.front().rotation.data());
  problem_->SetParameterBlockConstant(views_.front().translation.data());
  if (rank_ > 0) problem_->SetParameterBlockConstant(views_.front().courses.data());
}

void DeformingProblem::AddSmoothness() {
  const double mode_weight = 1.0 / (options_.mode_sigma * median_distance_);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    double* modes = points_[i].modes.data();
    problem_->AddResidualBlock(new LinearCost({mode_weight}, 3 * rank_), nullptr, modes);
    const auto count = std::min(neighbors_[i].size(), static_cast<std::size_t>(options_.neighbors));
    for (std::size_t k = 0; k < count; ++k) {
      const auto j = static_cast<std::size_t>(neighbors_[i][k]);
      const double weight = EdgeWeight((start_.points_in_world[j] - start_.points_in_world[i]).norm());
      problem_->AddResidualBlock(new LinearCost({weight, -weight}, 3 * rank_), nullptr, modes, points_[j].modes.data());
    }
  }
  for (std::size_t v = 1; v < views_.size(); ++v)
    problem_->AddResidualBlock(new LinearCost({1.0}, rank_), nullptr, views_[v].courses.data());
  for (std::size_t v = 1; v + 1 < views_.size(); ++v) {
    // The second derivative by divided differences.
    const double before = start_.times[v] - start_.times[v - 1];
    const double after = start_.times[v + 1] - start_.times[v];
    const double first = 2.0 / (before * (before + after)) / options_.acceleration_sigma;
    const double last = 2.0 / (after * (before + after)) / options_.acceleration_sigma;
    problem_->AddResidualBlock(new LinearCost({first, -first - last, last}, rank_), nullptr,
                               views_[v - 1].courses.data(), views_[v].courses.data(), views_[v + 1].courses.data());
  }
}

std::vector<int> DeformingProblem::GaugePoints() const {
  std::vector<int> near;
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (std::log(start_.points_in_world[i].norm() / median_distance_) < kGaugeReach)
      near.push_back(static_cast<int>(i));
  const std::size_t stride = std::max<std::size_t>(1, near.size() / kGaugePoints);
  std::vector<int> chosen;
  for (std::size_t k = 0; k < near.size(); k += stride) chosen.push_back(near[k]);
  return chosen;
}

void DeformingProblem::AddScale() {
  std::vector<double*> blocks;
  double mean = 0;
  for (const int i : GaugePoints()) {
    blocks.push_back(points_[static_cast<std::size_t>(i)].parameters.data());
    mean += blocks.back()[2];
  }
  mean /= static_cast<double>(blocks.size());
  scale_ =
      problem_->AddResidualBlock(new ScaleCost(static_cast<int>(blocks.size()), mean, kScaleWeight), nullptr, blocks);
}

void DeformingProblem::AddLight() {
  std::vector<double> light(points_.size(), std::numeric_limits<double>::quiet_NaN());
  for (const DeformingObservation& observation : start_.observations)
    if (observation.view_idx == 0) light[static_cast<std::size_t>(observation.point_idx)] = observation.log_light;
  light = CorrectForSlope(start_.points_in_world, neighbors_, light);
  std::vector<double> offsets;
  for (std::size_t i = 0; i < light.size(); ++i)
    if (std::isfinite(light[i])) offsets.push_back(points_[i].parameters.z() - light[i]);
  light_offset_ = offsets.empty() ? std::log(median_distance_) : Median(std::move(offsets));
  for (std::size_t i = 0; i < points_.size(); ++i) {
    double* point = points_[i].parameters.data();
    if (std::isfinite(light[i])) {
      problem_->AddResidualBlock(new LightCost(light[i], options_.light_sigma), &light_loss_, point, &light_offset_);
    } else {
      problem_->AddResidualBlock(new LightCost(point[2] - light_offset_, kFarSigma), nullptr, point, &light_offset_);
    }
  }
}

void DeformingProblem::FixPoints() {
  for (Point& point : points_) {
    problem_->SetParameterBlockConstant(point.parameters.data());
    if (rank_ > 0) problem_->SetParameterBlockConstant(point.modes.data());
  }
}

void DeformingProblem::FixViews() {
  problem_->RemoveResidualBlock(scale_);
  for (View& view : views_) {
    problem_->SetParameterBlockConstant(view.rotation.data());
    problem_->SetParameterBlockConstant(view.translation.data());
    if (rank_ > 0) problem_->SetParameterBlockConstant(view.courses.data());
  }
}

Result<double> DeformingProblem::Solve(int max_iterations) {
  ceres::Solver::Options options;
  // Eigen's: simplicial, several times as fast here as a supernodal factorisation on the reference BLAS.
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.max_num_iterations = max_iterations;
  options.function_tolerance = 1e-4;
  // Along the curved valley of modes against courses Levenberg-Marquardt takes five times the steps.
  options.trust_region_strategy_type = ceres::DOGLEG;
  options.dogleg_type = ceres::SUBSPACE_DOGLEG;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, problem_.get(), &summary);
  if (!summary.IsSolutionUsable())
    return Status(ErrorCode::kDegenerate, "the deforming window has no step that improves it");
  // As if each were off by a right angle.
  const double unmeasured = 0.5 * std::log1p(std::pow(0.5 * std::numbers::pi * focal_px_ / options_.loss_scale_px, 2));
  return summary.final_cost + unmeasured_ * unmeasured;
}

DeformingWindow DeformingProblem::Window() const {
  DeformingWindow window = start_;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    window.cams_from_world[v] = Rigid3(ReadQuaternion(views_[v].rotation.data()), views_[v].translation);
    if (rank_ > 0) window.courses.col(static_cast<Eigen::Index>(v)) = views_[v].courses;
  }
  for (std::size_t i = 0; i < points_.size(); ++i) {
    window.points_in_world[i] = points_[i].chart.Point(points_[i].parameters);
    if (rank_ > 0) window.modes[i] = points_[i].modes.reshaped(3, rank_);
  }
  return window;
}

}  // namespace pliant
