// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/window/still_camera.h"

#include <algorithm>
#include <cmath>
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

// Angles between the rays that were seen and where the points are, in the order of the observations of these views.
std::vector<double> ErrorsIn(const DeformingWindow& window, const std::vector<int>& view_idxs) {
  std::vector<double> errors;
  for (const DeformingObservation& observation : window.observations) {
    if (std::find(view_idxs.begin(), view_idxs.end(), observation.view_idx) == view_idxs.end()) continue;
    const Eigen::Vector3d x = window.cams_from_world[static_cast<std::size_t>(observation.view_idx)] *
                              window.Position(observation.point_idx, observation.view_idx);
    errors.push_back(AngleBetween(x, observation.ray));
  }
  return errors;
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

double StillCameraErrorRatio(const CameraMotionModels& models, const std::vector<int>& view_idxs,
                             double min_angle_rad) {
  const std::vector<double> moving = ErrorsIn(models.moving, view_idxs);
  const std::vector<double> still = ErrorsIn(models.still, view_idxs);
  if (moving.empty()) return 1.0;
  const double least = kMinError * Median(moving);
  double sum = 0;
  for (std::size_t k = 0; k < moving.size(); ++k)
    sum += std::log(std::hypot(still[k], least) / std::hypot(moving[k], least));
  return std::max(std::exp(sum / static_cast<double>(moving.size())),
                  SharedErrorRatio(ErrorsOfNeighbors(models.moving, view_idxs, min_angle_rad),
                                   ErrorsOfNeighbors(models.still, view_idxs, min_angle_rad)));
}

}  // namespace pliant
