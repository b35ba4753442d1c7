// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A scene small enough for tests, and the truth about it, worked out here again without the simulator's code.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <tbb/global_control.h>

#include "pliant/simulation/simulator.h"

namespace pliant::simulation_test {

// A ray hits the moved triangle, the formula moves the material itself: they differ by the chord, here seen from 25 mm.
inline constexpr double kChord_px = 0.02;
inline constexpr double kRayDepth_mm = 1e-3;                 // rays are traced in floats; of some 60 mm
inline constexpr std::size_t kMinWarped = 160U * 120U / 4U;  // pixels that both views see on smooth surface
inline constexpr std::size_t kMinSeen = 50;                  // points of a grid, of which half may be hidden

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

inline Simulator Make(const SimulationOptions& options) {
  Result<Simulator> simulator = Simulator::Create(options);
  EXPECT_TRUE(simulator.ok()) << simulator.status().message();
  return *std::move(simulator);
}

inline double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

inline bool SamePixels(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && std::equal(a.datastart, a.dataend, b.datastart, b.dataend);
}

// A frame's image and depth are the same bytes on one thread and on four. More workers than cores, so that the second
// run is parallel wherever the test runs.
inline void ExpectSameBytesOnFourThreads(SimulationOptions options, const std::vector<int>& frames) {
  const tbb::global_control workers(tbb::global_control::max_allowed_parallelism, 4);
  options.threads = 1;
  Simulator one = Make(options);
  options.threads = 4;
  Simulator four = Make(options);
  for (const int frame_idx : frames) {
    const SimulatedFrame a = one.Render(frame_idx);
    const SimulatedFrame b = four.Render(frame_idx);
    EXPECT_TRUE(SamePixels(a.image, b.image)) << frame_idx;
    EXPECT_TRUE(SamePixels(a.depth, b.depth)) << frame_idx;
  }
}

// |depth of the second frame at the projection - z of the first frame's point there|, over unoccluded smooth pixels.
inline std::vector<double> WarpErrors(Simulator& simulator, int from, int to) {
  const Pinhole160 pinhole;
  const cv::Mat depth_from = simulator.Render(from).depth.clone();
  const cv::Mat depth_to = simulator.Render(to).depth.clone();
  const Rigid3 to_from_from = simulator.WorldFromCamera(to).Inverse() * simulator.WorldFromCamera(from);
  constexpr double kSmoothMm = 1.0;
  constexpr double kOccludedMm = 1.5;
  std::vector<double> errors;
  for (int y = 0; y < depth_from.rows; ++y) {
    for (int x = 0; x < depth_from.cols; ++x) {
      const double z = depth_from.at<float>(y, x);
      if (!(z > 0)) continue;
      const Eigen::Vector3d point = to_from_from * pinhole.BackProject(x, y, z);
      const auto seen = SmoothDepth(depth_to, pinhole.Project(point), kSmoothMm);
      if (seen && std::abs(*seen - point.z()) < kOccludedMm) errors.push_back(std::abs(*seen - point.z()));
    }
  }
  return errors;
}

// The green level between four pixels; nothing outside.
inline std::optional<double> SmoothLevel(const cv::Mat& image, const Eigen::Vector2d& pixel) {
  const int x = static_cast<int>(std::floor(pixel.x()));
  const int y = static_cast<int>(std::floor(pixel.y()));
  if (x < 0 || y < 0 || x + 1 >= image.cols || y + 1 >= image.rows) return std::nullopt;
  const double s = pixel.x() - x;
  const double t = pixel.y() - y;
  const auto level = [&](int u, int v) { return static_cast<double>(image.at<cv::Vec3b>(v, u)[1]); };
  return (1 - t) * ((1 - s) * level(x, y) + s * level(x + 1, y)) +
         t * ((1 - s) * level(x, y + 1) + s * level(x + 1, y + 1));
}

}  // namespace pliant::simulation_test
