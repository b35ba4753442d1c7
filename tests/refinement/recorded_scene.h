// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A wavy surface that deforms, recorded by a camera that goes sideways over it: points enter and leave the view.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/random.h"
#include "pliant/base/statistics.h"
#include "pliant/camera/camera.h"
#include "pliant/refinement/refine_recording.h"

namespace pliant::refinement_test {

inline constexpr double kNoisePx = 0.05;
inline constexpr double kStartError = 0.04;  // relative, of a point's depth: the same in all views

inline const Camera& RecordingCamera() {
  static const Camera camera = Camera::Create("PINHOLE", 640, 480, std::vector<double>{450, 450, 319.5, 239.5}).value();
  return camera;
}

struct RecordedScene {
  double amplitude_mm = 4;
  int views = 40;
  Camera camera = RecordingCamera();
  std::vector<Eigen::Vector3d> points;
  std::vector<Rigid3> poses;

  explicit RecordedScene(double amplitude = 4) : amplitude_mm(amplitude) {
    Random random(3);
    for (int i = 0; i < 240; ++i) {
      const double x = random.Uniform(-35, 75);
      const double y = random.Uniform(-25, 25);
      points.emplace_back(x, y, 60 + 12 * std::sin(x / 14) * std::cos(y / 18));
    }
    for (int v = 0; v < views; ++v)
      poses.emplace_back(RotationExp(Eigen::Vector3d(0.02 * std::sin(0.2 * v), 0.01 * std::sin(0.3 * v), 0.003 * v)),
                         Eigen::Vector3d(-1.0 * v, 0.6 * std::sin(0.15 * v), 0.2 * v));
  }

  Eigen::Vector3d At(int point, int view) const {
    const Eigen::Vector3d& rest = points[static_cast<std::size_t>(point)];
    return rest + Eigen::Vector3d(0, 0, amplitude_mm * std::sin(0.35 * view + 0.03 * (rest.x() + rest.y())));
  }

  // True tracks with noise, true poses, and every point at a wrong depth. `drift_px`: standard deviation of how far a
  // track drifts from the first to the last view.
  Recording Start(double drift_px = 0) const {
    Random random(4);
    Recording recording;
    recording.log_depth_sigma = kStartError;
    std::vector<double> factors;
    std::vector<int> seen(points.size(), 0);
    std::vector<Eigen::Vector2d> drifts_px;
    for (std::size_t i = 0; i < points.size(); ++i) {
      Random own = random.Child("drift").Child(std::to_string(i));
      drifts_px.emplace_back(own.Normal(drift_px), own.Normal(drift_px));
    }
    for (std::size_t i = 0; i < points.size(); ++i) factors.push_back(std::exp(random.Normal(kStartError)));
    recording.rest_positions.assign(points.size(), Eigen::Vector3d::Zero());
    for (int v = 0; v < views; ++v) {
      const Rigid3& pose = poses[static_cast<std::size_t>(v)];
      recording.times.push_back(v);
      recording.cams_from_world.push_back(pose);
      for (int i = 0; i < static_cast<int>(points.size()); ++i) {
        const Eigen::Vector3d in_cam = pose * At(i, v);
        const auto pixel = camera.Project(in_cam);
        if (!pixel || !camera.Contains(*pixel)) continue;
        const Eigen::Vector3d position =
            pose.Inverse() * Eigen::Vector3d(factors[static_cast<std::size_t>(i)] * in_cam);
        const Eigen::Vector2d drift = static_cast<double>(v) / views * drifts_px[static_cast<std::size_t>(i)];
        recording.observations.push_back(
            {v, i, *pixel + drift + Eigen::Vector2d(random.Normal(kNoisePx), random.Normal(kNoisePx)), position});
        recording.rest_positions[static_cast<std::size_t>(i)] += position;
        ++seen[static_cast<std::size_t>(i)];
      }
    }
    for (std::size_t i = 0; i < seen.size(); ++i) recording.rest_positions[i] /= std::max(1, seen[i]);
    return recording;
  }

  // Error of the log distance of every observation, after the best scale of each view.
  std::vector<double> LogDistanceErrors(const Recording& recording) const {
    std::vector<double> errors;
    std::vector<std::vector<double>> of_view(recording.times.size());
    for (const RecordedObservation& o : recording.observations) {
      const auto view = static_cast<std::size_t>(o.view_idx);
      errors.push_back(std::log((recording.cams_from_world[view] * o.position).norm() /
                                (poses[view] * At(o.point_idx, o.view_idx)).norm()));
      of_view[view].push_back(errors.back());
    }
    for (std::size_t o = 0; o < errors.size(); ++o)
      errors[o] -= Median(of_view[static_cast<std::size_t>(recording.observations[o].view_idx)]);
    return errors;
  }

  // Median of their absolute values.
  double DepthError(const Recording& recording) const {
    std::vector<double> errors = LogDistanceErrors(recording);
    for (double& error : errors) error = std::abs(error);
    return Median(errors);
  }
};

}  // namespace pliant::refinement_test
