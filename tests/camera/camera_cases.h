// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The cameras that every property is checked on: each model with weak and with strong distortion, real calibrations
// among them.
#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pliant/base/random.h"
#include "pliant/camera/camera.h"

namespace pliant {

struct CameraCase {
  std::string label;
  std::string model;
  int width;
  int height;
  std::vector<double> params;

  Camera Make() const { return Camera::Create(model, width, height, params).value(); }
};

inline void PrintTo(const CameraCase& camera, std::ostream* out) { *out << camera.label; }

inline std::vector<CameraCase> CameraCases() {
  return {
      {"SimplePinhole", "SIMPLE_PINHOLE", 640, 480, {500, 320.5, 238}},
      {"Pinhole", "PINHOLE", 1280, 1024, {1120.2, 1118.7, 642.2, 520.7}},
      {"SimpleRadialBarrel", "SIMPLE_RADIAL", 640, 480, {500, 320.5, 238, -0.18}},
      {"SimpleRadialPincushion", "SIMPLE_RADIAL", 640, 480, {500, 320.5, 238, 0.3}},
      {"Radial", "RADIAL", 640, 480, {450, 310, 250, -0.25, 0.09}},
      {"RadialGrowingThenFolding", "RADIAL", 640, 480, {450, 310, 250, 0.2, -0.05}},
      {"OpenCvMild", "OPENCV", 1280, 720, {900, 905, 639, 361, -0.05, 0.01, 1e-3, -5e-4}},
      {"OpenCvHamlyn",
       "OPENCV",
       720,
       288,
       {755.3127, 420.4777, 327.875, 165.4844, -.186853, .122769, -.010146, -.003869}},
      {"OpenCvUndistorted", "OPENCV", 640, 480, {500, 500, 319.5, 239.5, 0, 0, 0, 0}},
      {"OpenCvTangential", "OPENCV", 640, 480, {600, 590, 319.5, 239.5, 0.02, -0.01, 0.02, -0.03}},
      {"FisheyeEndomapper",
       "OPENCV_FISHEYE",
       1440,
       1080,
       {726.7941, 727.7907, 742.7416, 542.1428, -.1289632, -.006051189, .001660961, -7.847858e-05}},
      {"FisheyeEquidistant", "OPENCV_FISHEYE", 800, 800, {250, 251, 399, 401, 0, 0, 0, 0}},
      {"FisheyeGrowing", "OPENCV_FISHEYE", 640, 480, {200, 205, 322, 236, 0.01, 0.002, -1e-4, 1e-5}},
  };
}

inline std::string CaseName(const testing::TestParamInfo<CameraCase>& info) { return info.param.label; }

// Pixels over the whole image, borders included.
inline std::vector<Eigen::Vector2d> PixelGrid(const Camera& camera, int columns = 41, int rows = 31) {
  std::vector<Eigen::Vector2d> pixels;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i)
      pixels.emplace_back((camera.width() - 1.0) * i / (columns - 1), (camera.height() - 1.0) * j / (rows - 1));
  return pixels;
}

// Points that are seen: rays through random pixels at random distances.
inline std::vector<Eigen::Vector3d> SeenPoints(const Camera& camera, int count) {
  Random random(7);
  std::vector<Eigen::Vector3d> points;
  while (static_cast<int>(points.size()) < count) {
    const Eigen::Vector2d pixel(random.Uniform(0, camera.width() - 1), random.Uniform(0, camera.height() - 1));
    if (const auto ray = camera.Unproject(pixel)) points.push_back(random.Uniform(5, 200) * *ray);
  }
  return points;
}

}  // namespace pliant
