// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/window/deforming_uncertainty.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "estimation/window/light_depth.h"
#include "pliant/base/statistics.h"
#include "pliant/estimation/window/shape_basis.h"

namespace pliant {
namespace {

// A solution adapts to the noise, and shapes to their priors: what is found of them is so many times too small.
constexpr double kCaution = 2.0;

// The views in which solutions are compared: the first, the middle and the last.
std::array<int, 3> ComparedViews(const DeformingWindow& window) {
  const int views = static_cast<int>(window.cams_from_world.size());
  return {0, views / 2, views - 1};
}

// (W8) How far the window's shape in the compared views is from what the light says of it, and from one distance for
// all; zeros: no light.
LightFit CompareWindowWithLight(const DeformingWindow& window) {
  const std::array<int, 3> views = ComparedViews(window);
  std::vector<LightFit> fits;
  for (const int view : views) {
    std::vector<Eigen::Vector3d> positions;
    std::vector<double> log_cue;
    for (const DeformingObservation& observation : window.observations) {
      if (observation.view_idx != view) continue;
      positions.push_back(window.cams_from_world[static_cast<std::size_t>(view)] *
                          window.Position(observation.point_idx, view));
      log_cue.push_back(observation.log_cue);
    }
    const LightFit fit =
        window.cue == DistanceCue::kLight ? CompareWithLight(positions, log_cue) : CompareWithPrior(positions, log_cue);
    if (fit.error > 0.0) fits.push_back(fit);
  }
  // Every frame has a brightness; a depth prior may lack in some.
  if (fits.empty() || (window.cue == DistanceCue::kLight && fits.size() < views.size())) return {};
  LightFit mean;
  for (const LightFit& fit : fits) {
    mean.error += fit.error / static_cast<double>(fits.size());
    mean.spread += fit.spread / static_cast<double>(fits.size());
  }
  return mean;
}

}  // namespace

DeformingSolution MakeSolution(const DeformingProblem& problem, double cost, const SurfaceNodes& nodes) {
  DeformingSolution solution;
  solution.cost = cost;
  solution.window = problem.Window();
  const LightFit light = CompareWindowWithLight(solution.window);
  solution.light_error = light.error;
  solution.log_distance_spread = light.spread;
  solution.nodes = {nodes.positions, problem.NodeShapes()};
  return solution;
}

bool MorePlausible(const DeformingSolution& a, const DeformingSolution& b) {
  double difference = a.cost - b.cost;
  if (a.light_error > 0.0 && b.light_error > 0.0)
    difference += static_cast<double>(a.window.points_in_world.size()) * std::log(a.light_error / b.light_error);
  return difference < 0.0;
}

std::vector<double> SigmasBetween(const std::vector<const DeformingSolution*>& samples, std::size_t points) {
  if (samples.size() < 2) return {};
  if (samples[0] == nullptr || samples[1] == nullptr)
    return std::vector<double>(points, std::numeric_limits<double>::infinity());
  const DeformingWindow& first = samples[0]->window;
  const DeformingWindow& second = samples[1]->window;
  const std::array<int, 3> views = ComparedViews(first);
  std::vector<double> squares(points, 0.0);
  for (const int view : views) {
    const auto v = static_cast<std::size_t>(view);
    std::vector<double> differences;
    for (std::size_t i = 0; i < points; ++i)
      differences.push_back(std::log((first.cams_from_world[v] * first.Position(static_cast<int>(i), view)).norm() /
                                     (second.cams_from_world[v] * second.Position(static_cast<int>(i), view)).norm()));
    const double scale = Median(differences);
    for (std::size_t i = 0; i < points; ++i) squares[i] += std::pow(differences[i] - scale, 2);
  }
  for (double& square : squares) square = std::sqrt(square / (2.0 * static_cast<double>(views.size())));
  return squares;
}

double FoundNoisePx(const DeformingWindow& window, double focal_px) {
  return kCaution * Median(PointErrorsPx(window, focal_px));
}

std::vector<double> FoundLogDepthSigmas(const DeformingSolution& solution, double noise_px, std::size_t gauge_points,
                                        double focal_px, const DeformingWindowOptions& options, int threads) {
  constexpr double kMinNoisePx = 0.05;
  constexpr double kMinSigma = 0.01;
  DeformingWindowOptions found = options;
  const DeformingWindow& window = solution.window;
  found.loss_scale_px = std::max(kMinNoisePx, noise_px);
  if (window.coefficients.rows() > 0) {
    const ShapeSizes sizes = SizesOf(solution.nodes);
    found.shape_sigma = std::max(kMinSigma, kCaution * sizes.size / window.MedianDistance());
    found.gradient_sigma = std::max(kMinSigma, kCaution * sizes.gradient);
  }
  return DeformingProblem(window, solution.nodes, focal_px, found, gauge_points).LogDepthSigmas(threads);
}

}  // namespace pliant
