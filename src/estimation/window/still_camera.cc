// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/window/still_camera.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "estimation/window/deforming_problem.h"
#include "estimation/window/window_samples.h"
#include "pliant/base/statistics.h"
#include "pliant/estimation/window/shape_basis.h"
#include "pliant/geometry/triangulation.h"

namespace pliant {
namespace {

constexpr int kIterationsFactor = 5;  // of a solution's iterations: the still camera starts far from its minimum
constexpr double kMinError = 0.2;     // by the median one
constexpr double kNoiseSigmas = 3.0;  // what noise alone may leave, in standard deviations of its correlation

// The camera's translation as three uniform basis shapes, one an axis of the world.
void GiveTranslationToScene(DeformingWindow* window, SurfaceNodes* nodes) {
  const Eigen::Index rank = window->coefficients.rows();
  Eigen::MatrixXd coefficients(rank + 3, window->coefficients.cols());
  coefficients.topRows(rank) = window->coefficients;
  for (std::size_t v = 0; v < window->cams_from_world.size(); ++v) {
    Rigid3& pose = window->cams_from_world[v];
    coefficients.col(static_cast<Eigen::Index>(v)).tail<3>() = pose.rotation.conjugate() * pose.translation;
    pose.translation.setZero();
  }
  window->coefficients = std::move(coefficients);
  for (Eigen::Matrix3Xd& shapes : window->shapes) {
    shapes.conservativeResize(Eigen::NoChange, rank + 3);
    shapes.rightCols<3>().setIdentity();
  }
  const Eigen::Matrix<double, 9, 1> uniform = Eigen::Matrix3d::Identity().reshaped();
  nodes->shapes.conservativeResize(3 * (rank + 3), Eigen::NoChange);
  nodes->shapes.bottomRows<9>().colwise() = uniform;
  window->camera = WindowCamera::kRotation;
}

Result<DeformingWindow> Solved(const DeformingWindow& start, const SurfaceNodes& nodes, double focal_px,
                               const DeformingWindowOptions& options, int threads) {
  DeformingProblem problem(start, nodes, focal_px, options);
  const auto cost = problem.Solve(kIterationsFactor * options.max_iterations, threads);
  if (!cost.ok()) return cost.status();
  return problem.Window();
}

// The angle between a ray that was seen and where its point is.
double ErrorOf(const DeformingObservation& observation, const DeformingWindow& window) {
  const Eigen::Vector3d x = window.cams_from_world[static_cast<std::size_t>(observation.view_idx)] *
                            window.Position(observation.point_idx, observation.view_idx);
  return AngleBetween(x, observation.ray);
}

// Of one observation, under both models.
struct ErrorPair {
  int point_idx = 0;
  double moving = 0;
  double still = 0;
};

std::vector<ErrorPair> ErrorsIn(const CameraMotionModels& models, const std::vector<int>& view_idxs) {
  std::vector<ErrorPair> errors;
  for (std::size_t k = 0; k < models.moving.observations.size(); ++k) {
    const DeformingObservation& seen = models.moving.observations[k];
    if (std::ranges::find(view_idxs, seen.view_idx) == view_idxs.end()) continue;
    errors.push_back(
        {seen.point_idx, ErrorOf(seen, models.moving), ErrorOf(models.still.observations[k], models.still)});
  }
  return errors;
}

// The mean of the points' values by its standard error; 0 where there are fewer than two or they do not differ.
double StandardErrorsFromZero(const std::vector<double>& values) {
  const double error = StandardError(values);
  return error > 0.0 ? Mean(values) / error : 0.0;
}

// The ratio of the errors that neighbors share, where the moving camera leaves noise alone; else 0.
double SharedErrorRatio(const NeighborErrors& moving, const NeighborErrors& still) {
  if (moving.Correlation() > kMaxNoiseCorrelation || still.Correlation() <= kMaxNoiseCorrelation) return 0.0;
  const double noise = kNoiseSigmas * moving.correlation_sigma * moving.all;
  return std::sqrt((still.shared + noise) / (std::max(moving.shared, 0.0) + noise));
}

}  // namespace

Result<CameraMotionModels> SolveCameraMotionModels(const DeformingSolution& solution, double focal_px,
                                                   const DeformingWindowOptions& options, int threads) {
  if (Status status = CheckWindow(solution.window); !status.ok()) return status;
  if (solution.window.coefficients.rows() == 0)
    return {ErrorCode::kInvalidArgument,
            "a rigid window has no deformation that could stand in for the camera's motion"};
  const int rank = std::min(kModelRank, static_cast<int>(solution.window.coefficients.rows()));
  const auto of_rank = [&](DeformingWindow window, SurfaceNodes nodes) {
    KeepStrongestShapes(rank, &window, &nodes);
    return Solved(window, nodes, focal_px, options, threads);
  };
  const std::vector<int> sample = SpreadPoints(solution.window.points_in_world, 2 * options.sample_points);
  DeformingWindow window = PartOf(solution.window, sample);
  window.coefficients = solution.window.coefficients;
  for (const int i : sample) window.shapes.push_back(solution.window.shapes[static_cast<std::size_t>(i)]);
  auto moving = of_rank(window, solution.nodes);
  if (!moving.ok()) return moving.status();
  SurfaceNodes nodes = solution.nodes;
  GiveTranslationToScene(&window, &nodes);
  auto still = of_rank(std::move(window), std::move(nodes));
  if (!still.ok()) return still.status();
  return CameraMotionModels{sample, std::move(*moving), std::move(*still)};
}

CameraMotionEvidence EvidenceOfCameraMotion(const CameraMotionModels& models, const std::vector<int>& view_idxs,
                                            double min_angle_rad) {
  const std::vector<ErrorPair> errors = ErrorsIn(models, view_idxs);
  if (errors.empty()) return {};
  std::vector<double> of_moving;
  for (const ErrorPair& error : errors) of_moving.push_back(error.moving);
  const double least = kMinError * Median(std::move(of_moving));
  double sum = 0;
  std::map<int, std::pair<double, int>> of_points;  // sums and counts
  for (const ErrorPair& error : errors) {
    const double log_ratio = std::log(std::hypot(error.still, least) / std::hypot(error.moving, least));
    sum += log_ratio;
    auto& [of_point, count] = of_points[error.point_idx];
    of_point += log_ratio;
    ++count;
  }
  std::vector<double> means;
  for (const auto& [point, of_point] : of_points) means.push_back(of_point.first / of_point.second);
  const NeighborErrors moving = ErrorsOfNeighbors(models.moving, view_idxs, min_angle_rad);
  const NeighborErrors still = ErrorsOfNeighbors(models.still, view_idxs, min_angle_rad);
  return {std::max(std::exp(sum / static_cast<double>(errors.size())), SharedErrorRatio(moving, still)),
          StandardErrorsFromZero(means), moving.Correlation() <= kMaxNoiseCorrelation};
}

}  // namespace pliant
