// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/bootstrapping/focal_length_check.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "pliant/base/statistics.h"
#include "tracking/bootstrapping/window_solution.h"

namespace pliant {
namespace {

constexpr double kFactors[] = {0.5, 0.6, 0.75, 1.33, 1.7, 2.0};
constexpr double kFirstStep = 1.15;     // from the best of them towards the next, as a factor
constexpr int kRefinements = 3;         // each by a step that is half as long: to 2 %
constexpr double kMinErrorRatio = 1.1;  // of the errors with the calibration's focal length by those with another one
constexpr double kMinErrorPx = 0.01;    // smaller errors are those of the solver
constexpr int kMaxPoints = 80;          // in as few views as a deforming window has: they tell enough

struct RigidFit {
  double error_px = 0;
  double correlation = 0;  // of neighbors' errors (W11)
};

// The distance in the image between where a point was seen and where it is: the median, without the reference's.
double MedianErrorPx(const DeformingWindow& window, const Camera& camera) {
  std::vector<double> errors;
  for (const DeformingObservation& seen : window.observations) {
    if (seen.view_idx == 0) continue;
    const auto pixel = camera.Project(seen.ray);
    const auto solved = camera.Project(window.cams_from_world[static_cast<std::size_t>(seen.view_idx)] *
                                       window.Position(seen.point_idx, seen.view_idx));
    if (pixel && solved) errors.push_back((*pixel - *solved).norm());
  }
  return Median(std::move(errors));
}

std::optional<RigidFit> FitRigid(const InitInput& input, const Camera& camera, const WindowInitOptions& options,
                                 double nominal_depth_mm) {
  const InitInput with_camera{camera,        input.frames,           input.reference_depth_mm, input.moment,
                              input.threads, input.reference_depths, input.photometric};
  const auto window = SolveAsRigid(with_camera, input.frames.size(), options, nominal_depth_mm);
  if (!window.ok()) return std::nullopt;
  return RigidFit{std::max(kMinErrorPx, MedianErrorPx(window->solution.window, camera)),
                  window->solution.residual_correlation};
}

}  // namespace

double ContradictingFocalLengthFactor(const InitInput& input, const WindowInitOptions& options,
                                      double nominal_depth_mm) {
  WindowInitOptions fewer = options;
  fewer.max_points = std::min(options.max_points, kMaxPoints);
  fewer.rigid_views = std::min(options.rigid_views, options.views);
  const auto fit = [&](double factor) -> std::optional<RigidFit> {
    const auto camera = input.camera.WithFocalLengthTimes(factor);
    return camera.ok() ? FitRigid(input, *camera, fewer, nominal_depth_mm) : std::nullopt;
  };
  const auto calibrated = fit(1.0);
  if (!calibrated) return 1.0;
  double best_factor = 1.0;
  RigidFit best = *calibrated;
  const auto try_factor = [&](double factor) {
    const auto other = fit(factor);
    if (!other || other->error_px >= best.error_px) return;
    best_factor = factor;
    best = *other;
  };
  for (const double factor : kFactors) try_factor(factor);
  if (best_factor == 1.0) return 1.0;
  // The minimum lies between the neighbors of the best one: on both sides of it, nearer and nearer.
  double step = kFirstStep;
  for (int k = 0; k < kRefinements; ++k, step = std::sqrt(step)) {
    const double center = best_factor;
    try_factor(center * step);
    try_factor(center / step);
  }
  const bool explains = best.correlation <= kMaxNoiseCorrelation;
  return explains && kMinErrorRatio * best.error_px <= calibrated->error_px ? best_factor : 1.0;
}

}  // namespace pliant
