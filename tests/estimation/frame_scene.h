// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A synthetic frame: a bumpy surface 50 mm in front of the camera, points on it that move smoothly between two frames,
// a camera that moves too, and the pixels of the second frame. All knobs at zero: exact, rigid data.
#pragma once

#include <cmath>
#include <string_view>
#include <vector>

#include "pliant/base/random.h"
#include "pliant/camera/camera.h"
#include "pliant/deformation/graph.h"
#include "pliant/estimation/frame/frame_problem.h"
#include "pliant/estimation/pose/camera_pose.h"

namespace pliant {

struct FrameSceneOptions {
  int num_points = 500;
  double deformation_mm = 0.3;  // amplitude of the smooth motion between the frames
  double pixel_noise_px = 0.3;  // standard deviation
  double outlier_ratio = 0.03;  // pixels displaced by 5 to 20 px
  std::uint64_t seed = 1;
  std::string_view camera_model = "PINHOLE";  // or OPENCV_FISHEYE
};

struct FrameScene {
  Camera camera = Camera::Create("PINHOLE", 640, 480, std::vector<double>{500, 500, 319.5, 239.5}).value();
  std::vector<Eigen::Vector3d> positions;       // X(t-1), world
  std::vector<Eigen::Vector3d> true_positions;  // X(t)
  std::vector<Eigen::Vector2d> pixels;          // u(t)
  std::vector<char> is_outlier;
  Rigid3 before_last_cam_from_world;
  Rigid3 last_cam_from_world;
  Rigid3 true_cam_from_world;  // not quite of constant velocity
  DeformationGraph graph;      // of `positions`, K = 20

  FrameProblemInput Input(const Rigid3& initial_cam_from_world) const {
    return {positions, pixels, graph.edges, initial_cam_from_world};
  }
};

inline Rigid3 Predicted(const FrameScene& scene) {
  return PredictCameraPose(scene.before_last_cam_from_world, scene.last_cam_from_world);
}

inline FrameScene MakeFrameScene(const FrameSceneOptions& options) {
  Random random = Random(options.seed).Child("frame scene");
  FrameScene scene;
  if (options.camera_model == "OPENCV_FISHEYE")
    scene.camera = Camera::Create(options.camera_model, 640, 480,
                                  std::vector<double>{500, 500, 319.5, 239.5, -0.02, 0.005, 0.0, 0.0})
                       .value();
  scene.before_last_cam_from_world = Rigid3(RotationExp({0.21, -0.1, 0.05}), {1.0, -2.0, 3.0});
  const Rigid3 step(RotationExp({0.004, -0.003, 0.002}), {0.3, -0.2, -0.35});
  const Rigid3 jerk(RotationExp({-0.001, 0.0008, 0.0005}), {-0.04, 0.05, 0.03});
  scene.last_cam_from_world = step * scene.before_last_cam_from_world;
  scene.true_cam_from_world = jerk * step * scene.last_cam_from_world;
  const Rigid3 world_from_last = scene.last_cam_from_world.Inverse();
  for (int i = 0; i < options.num_points; ++i) {
    const double x = random.Uniform(-28, 28);
    const double y = random.Uniform(-20, 20);
    const Eigen::Vector3d in_cam(x, y, 50 + 0.2 * x + 4 * std::sin(x / 8) * std::cos(y / 9) + std::sin(y / 3));
    const Eigen::Vector3d motion(std::sin(x / 12 + 0.3), 0.7 * std::cos(y / 10), std::sin((x + y) / 15));
    scene.positions.push_back(world_from_last * in_cam);
    scene.true_positions.push_back(world_from_last * (in_cam + options.deformation_mm * motion));
    Eigen::Vector2d pixel = scene.camera.Project(scene.true_cam_from_world * scene.true_positions.back()).value();
    pixel.x() += random.Normal(options.pixel_noise_px);
    pixel.y() += random.Normal(options.pixel_noise_px);
    scene.is_outlier.push_back(random.Uniform() < options.outlier_ratio);
    if (scene.is_outlier.back()) {
      const double angle = random.Uniform(0, 6.283);
      pixel += random.Uniform(5, 20) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    }
    scene.pixels.push_back(pixel);
  }
  scene.graph = BuildDeformationGraph(scene.positions, {}, {}).value();
  return scene;
}

}  // namespace pliant
