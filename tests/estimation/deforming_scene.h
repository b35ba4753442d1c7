// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A scene that deforms, as a window of views sees it.
#pragma once

#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "pliant/base/random.h"
#include "pliant/base/statistics.h"
#include "pliant/estimation/window/deforming_window.h"
#include "pliant/estimation/window/window_refinement.h"

namespace pliant::deforming_test {

inline constexpr double kFocalPx = 450;
inline constexpr double kNoisePx = 0.05;  // of a pixel followed well
inline constexpr double kShape = 0.02;    // median relative depth error; what the priors cost is below a third of it
inline constexpr double kWithinThreeSigmas = 0.95;  // of the errors; fewer than 99.7 %, for points share errors

// A wavy surface that waves, seen by a camera that goes forwards and sways: neither motion is small against the other.
struct DeformingScene {
  std::vector<Eigen::Vector3d> points;  // in the reference
  std::vector<Rigid3> poses;
  double amplitude_mm = 4;
  double noise_px = kNoisePx;

  explicit DeformingScene(int views = 13, double relief_mm = 15) {
    Random random(3);
    for (int i = 0; i < 150; ++i) {
      const double x = random.Uniform(-35, 35);
      const double y = random.Uniform(-25, 25);
      points.emplace_back(x, y, 60 + relief_mm * std::sin(x / 14) * std::cos(y / 18));
    }
    for (int v = 0; v < views; ++v) {
      const double t = 5.0 * v;
      poses.emplace_back(RotationExp(Eigen::Vector3d(0.02 * std::sin(0.05 * t), 0.01 * std::sin(0.08 * t), 0.001 * t)),
                         Eigen::Vector3d(0.5 * std::sin(0.06 * t), 0.4 * std::sin(0.05 * t), -0.5 * t));
    }
  }

  static double Time(int view) { return 5.0 * view; }

  // World frame.
  Eigen::Vector3d At(int point, int view) const {
    const Eigen::Vector3d& rest = points[static_cast<std::size_t>(point)];
    const double phase = 0.02 * rest.sum();
    return rest + Eigen::Vector3d(0, amplitude_mm * (std::sin(0.12 * Time(view) + phase) - std::sin(phase)), 0);
  }

  // All rays, with noise; every point at one distance, the views optimized against that.
  DeformingWindow Start(double light_sigma) const {
    Random random(4);
    DeformingWindow start;
    for (int v = 0; v < static_cast<int>(poses.size()); ++v) {
      start.times.push_back(Time(v));
      for (int i = 0; i < static_cast<int>(points.size()); ++i) {
        const Eigen::Vector3d x = poses[static_cast<std::size_t>(v)] * At(i, v);
        const double noise = noise_px / kFocalPx * x.norm();
        const Eigen::Vector3d seen = x + noise * Eigen::Vector3d(random.Normal(), random.Normal(), 0);
        DeformingObservation observation{v, i, seen.normalized()};
        if (light_sigma > 0) observation.log_cue = std::log(x.norm()) + 1.7 + random.Normal(light_sigma);
        start.observations.push_back(observation);
        if (v == 0) start.points_in_world.push_back(60 * observation.ray);
      }
    }
    start.cams_from_world.push_back(Rigid3());
    for (int v = 1; v < static_cast<int>(poses.size()); ++v) {
      Window rigid{{Rigid3(), start.cams_from_world.back()}, start.points_in_world, {}};
      for (const DeformingObservation& observation : start.observations)
        if (observation.view_idx == v) rigid.observations.push_back({1, observation.point_idx, observation.ray});
      start.cams_from_world.push_back(
          RefineWindow(rigid, kFocalPx, WindowPoints::kFixed, {.loss_scale_px = 5}).value().window.cams_from_world[1]);
    }
    return start;
  }

  // Relative depth errors of a view after the best scale.
  std::vector<double> DepthErrors(const DeformingWindow& window, int view) const {
    std::vector<double> ratios;
    for (int i = 0; i < static_cast<int>(points.size()); ++i)
      ratios.push_back((window.cams_from_world[static_cast<std::size_t>(view)] * window.Position(i, view)).norm() /
                       (poses[static_cast<std::size_t>(view)] * At(i, view)).norm());
    const double scale = Median(ratios);
    for (double& ratio : ratios) ratio = std::abs(ratio / scale - 1);
    return ratios;
  }
};

}  // namespace pliant::deforming_test
