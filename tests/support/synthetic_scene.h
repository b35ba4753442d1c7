// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Scenes with known truth for tests: points on a surface, a camera that moves, its pixels with noise and outliers.
// Every knob at zero gives exact pixels. World = the first camera (the reference). Millimetres, pixels.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pliant/base/random.h"
#include "pliant/geometry/rigid3.h"

namespace pliant::test {

enum class Surface {
  kTube,   // bumpy wall of 20 mm radius along z, seen from its axis, depths 20 to 120 mm
  kOrgan,  // a plane 50 mm away, tilted by 20 degrees, with bumps of relief_mm
  kPlane,  // the same, exactly flat
  kBlob,   // points anywhere, depths 30 to 90 mm
};

enum class Motion {
  kForward,   // along the optical axis
  kSideways,  // along x
  kRotation,  // about the camera's centre: no translation
  kStill,
};

struct SceneOptions {
  Surface surface = Surface::kTube;
  Motion motion = Motion::kForward;
  int num_points = 500;
  int num_frames = 9;         // the reference included
  double parallax_deg = 4.0;  // median of the visible points, between the first and the last frame
  double rotation_deg = 1.5;  // of the last frame
  double relief_mm = 3.0;
  double noise_px = 0.0;
  double outlier_share = 0.0;  // of the points: random pixels in every frame but the reference
  double focal_px = 450.0;
  int width = 640;
  int height = 480;
  std::uint64_t seed = 1;
};

struct Scene {
  std::vector<Rigid3> cams_from_world;               // the first is the identity
  std::vector<Eigen::Vector3d> points;               // world
  std::vector<std::vector<Eigen::Vector2d>> pixels;  // [frame][point]; may lie outside the image
  std::vector<char> is_outlier;                      // [point]
};

namespace internal {

inline double Bump(double a, double b) {
  return std::sin(3.0 * a + 0.5) * std::cos(2.0 * b) + 0.5 * std::sin(5.0 * a - b);
}

// The surface along one viewing direction of the reference camera.
inline Eigen::Vector3d PointAlong(const SceneOptions& options, const Eigen::Vector3d& ray, Random* random) {
  if (options.surface == Surface::kBlob) return ray / ray.z() * random->Uniform(30.0, 90.0);
  if (options.surface == Surface::kTube) {
    const double angle = std::atan2(ray.y(), ray.x());
    const double off_axis = std::hypot(ray.x(), ray.y()) / ray.z();
    double z = 20.0 / std::max(off_axis, 20.0 / 120.0);
    const double radius = 20.0 + options.relief_mm * Bump(angle, z / 15.0);
    z = std::min(radius / std::max(off_axis, 1e-9), 120.0);
    return ray / ray.z() * z;
  }
  const Eigen::Vector3d normal(0.0, std::sin(20.0 * std::numbers::pi / 180.0),
                               std::cos(20.0 * std::numbers::pi / 180.0));
  double z = 50.0 * normal.z() / normal.dot(ray / ray.z());
  if (options.surface == Surface::kOrgan)
    z += options.relief_mm * Bump(z * ray.x() / ray.z() / 12.0, z * ray.y() / ray.z() / 12.0);
  return ray / ray.z() * z;
}

inline Rigid3 PoseAt(const SceneOptions& options, double fraction, double baseline_mm) {
  const double angle = fraction * options.rotation_deg * std::numbers::pi / 180.0;
  const Eigen::Quaterniond rotation = RotationExp(angle * Eigen::Vector3d(0.3, 0.8, 0.5).normalized());
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  if (options.motion == Motion::kForward)
    centre = fraction * baseline_mm * Eigen::Vector3d(0.05, 0.02, 1.0).normalized();
  if (options.motion == Motion::kSideways)
    centre = fraction * baseline_mm * Eigen::Vector3d(1.0, 0.1, 0.1).normalized();
  if (options.motion == Motion::kStill) return {};
  return {rotation, rotation * -centre};
}

inline double MedianParallax(const SceneOptions& options, const std::vector<Eigen::Vector3d>& points,
                             double baseline_mm) {
  const Eigen::Vector3d centre = PoseAt(options, 1.0, baseline_mm).OriginInSource();
  std::vector<double> angles;
  for (const Eigen::Vector3d& x : points) {
    const Eigen::Vector3d y = x - centre;
    angles.push_back(std::atan2(x.cross(y).norm(), x.dot(y)));
  }
  std::nth_element(angles.begin(), angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 2), angles.end());
  return angles[angles.size() / 2] * 180.0 / std::numbers::pi;
}

// The baseline of the wanted median parallax, by bisection, at most 15 mm: farther forwards, near points fall behind.
inline double Baseline(const SceneOptions& options, const std::vector<Eigen::Vector3d>& points) {
  if (options.motion == Motion::kRotation || options.motion == Motion::kStill) return 0.0;
  double low = 0.0;
  double high = 15.0;
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (low + high);
    (MedianParallax(options, points, middle) < options.parallax_deg ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace internal

inline Scene MakeScene(const SceneOptions& options) {
  const Random root(options.seed);
  Random place = root.Child("points");
  Random noise = root.Child("noise");
  Random outlier = root.Child("outliers");
  const Eigen::Vector2d centre(0.5 * (options.width - 1), 0.5 * (options.height - 1));

  Scene scene;
  for (int i = 0; i < options.num_points; ++i) {
    const Eigen::Vector2d pixel(place.Uniform(0, options.width - 1), place.Uniform(0, options.height - 1));
    const Eigen::Vector3d ray = ((pixel - centre) / options.focal_px).homogeneous();
    scene.points.push_back(internal::PointAlong(options, ray, &place));
    scene.is_outlier.push_back(outlier.Uniform() < options.outlier_share ? 1 : 0);
  }
  const double baseline_mm = internal::Baseline(options, scene.points);
  for (int k = 0; k < options.num_frames; ++k) {
    const double fraction = options.num_frames > 1 ? static_cast<double>(k) / (options.num_frames - 1) : 0.0;
    scene.cams_from_world.push_back(internal::PoseAt(options, fraction, baseline_mm));
    auto& pixels = scene.pixels.emplace_back();
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      const Eigen::Vector3d x = scene.cams_from_world.back() * scene.points[i];
      Eigen::Vector2d pixel = options.focal_px * x.hnormalized() + centre;
      if (k > 0 && scene.is_outlier[i] != 0)
        pixel = {outlier.Uniform(0, options.width - 1), outlier.Uniform(0, options.height - 1)};
      const double dx = noise.Normal();
      const double dy = noise.Normal();
      pixels.emplace_back(pixel + options.noise_px * Eigen::Vector2d(dx, dy));
    }
  }
  return scene;
}

// Unit rays of one frame of a scene: a pinhole with the scene's focal length, its centre in the image's middle.
inline std::vector<Eigen::Vector3d> RaysOf(const Scene& scene, const SceneOptions& options, std::size_t frame) {
  const Eigen::Vector2d centre(0.5 * (options.width - 1), 0.5 * (options.height - 1));
  std::vector<Eigen::Vector3d> rays;
  for (const Eigen::Vector2d& pixel : scene.pixels[frame])
    rays.push_back(((pixel - centre) / options.focal_px).homogeneous().normalized());
  return rays;
}

}  // namespace pliant::test
