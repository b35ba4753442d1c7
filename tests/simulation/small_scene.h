// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A scene small enough for tests, and the truth about it, worked out here again without the simulator's code.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Core>

#include "pliant/simulation/simulator.h"

namespace pliant::simulation_test {

inline SimulationOptions SmallScene(TrajectoryKind trajectory, int frames) {
  SimulationOptions options;
  options.scene.mesh_step_mm = 0.8;
  options.scene.view_mm = 120;
  options.texture.texel_mm = 0.3;
  options.texture.smallest_mm = 0.8;
  options.camera.width = 160;
  options.camera.height = 120;
  options.trajectory.kind = trajectory;
  options.trajectory.frames = frames;
  return options;
}

// The pinhole that SmallScene's field of view makes.
struct Pinhole160 {
  double focal = 80.0 / std::tan(0.5 * SimulationOptions().camera.horizontal_fov_deg * M_PI / 180.0);
  Eigen::Vector3d BackProject(double u, double v, double z) const {
    return {(u - 79.5) / focal * z, (v - 59.5) / focal * z, z};
  }
  Eigen::Vector2d Project(const Eigen::Vector3d& x) const {
    return {focal * x.x() / x.z() + 79.5, focal * x.y() / x.z() + 59.5};
  }
};

// Depth between four pixels, where they lie on one smooth piece of surface (they differ by less than `step_mm`).
inline std::optional<double> SmoothDepth(const cv::Mat& depth, const Eigen::Vector2d& pixel, double step_mm) {
  const int x = static_cast<int>(std::floor(pixel.x()));
  const int y = static_cast<int>(std::floor(pixel.y()));
  if (x < 0 || y < 0 || x + 1 >= depth.cols || y + 1 >= depth.rows) return std::nullopt;
  const double a = depth.at<float>(y, x);
  const double b = depth.at<float>(y, x + 1);
  const double c = depth.at<float>(y + 1, x);
  const double d = depth.at<float>(y + 1, x + 1);
  if (!(std::min({a, b, c, d}) > 0) || std::max({a, b, c, d}) - std::min({a, b, c, d}) > step_mm) return std::nullopt;
  const double s = pixel.x() - x;
  const double t = pixel.y() - y;
  return (1 - t) * ((1 - s) * a + s * b) + t * ((1 - s) * c + s * d);
}

}  // namespace pliant::simulation_test
