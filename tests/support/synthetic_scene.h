// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Scenes with known truth for tests and experiments: points on a surface that may deform, a camera that moves, its
// pixels with noise and outliers, and how bright a light at the camera makes the points. Every knob at zero gives exact
// pixels of a rigid scene. World = the first camera (the reference). Millimeters, pixels, seconds.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pliant/base/options.h"
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
  kRotation,  // about the camera's center: no translation
  kStill,
};

// What the points do while the camera moves: a wave like the simulator's (docs/method.md, eq. S1) that is at rest in
// the reference, (0, A ( sin(omega t + phase) - sin(phase) ), 0), phase = 2 pi / wavelength (x + y + z).
struct SceneWave {
  double amplitude_mm = 0.0;
  double wavelength_mm = 200.0;  // along the sum of the coordinates
  double omega_rad_s = 2.5;
  double seconds = 0.0;  // from the first frame to the last
};

struct SceneOptions {
  Surface surface = Surface::kTube;
  Motion motion = Motion::kForward;
  int num_points = 500;
  int num_frames = 9;         // the reference included
  double parallax_deg = 4.0;  // median of the visible points, between the first and the last frame
  double rotation_deg = 1.5;  // of the last frame
  double relief_mm = 3.0;
  std::optional<double> baseline_mm = std::nullopt;  // of the last frame, in place of that of parallax_deg
  SceneWave wave = {};
  double noise_px = 0.0;
  double outlier_share = 0.0;  // of the points: random pixels in every frame but the reference
  double light_sigma = 0.0;    // of the log distance that a point's brightness speaks of, because albedo differs
  double focal_px = 450.0;
  int width = 640;
  int height = 480;
  std::uint64_t seed = 1;
};

struct Scene {
  std::vector<Rigid3> cams_from_world;  // the first is the identity
  std::vector<Eigen::Vector3d> points;  // world, in the reference
  std::vector<std::vector<Eigen::Vector2d>>
      pixels;                                   // [frame][point]; may lie outside the image; NaN: behind the camera
  std::vector<std::vector<double>> brightness;  // [frame][point], 0 to 255; 0: too dark or behind the camera
  std::vector<char> is_outlier;                 // [point]
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

// The surface's normal there, towards the camera; points that lie anywhere face it.
inline Eigen::Vector3d NormalAlong(const SceneOptions& options, const Eigen::Vector3d& ray, Random* random) {
  constexpr double kStep = 1e-4;  // of a ray with z = 1
  if (options.surface == Surface::kBlob) return -ray.normalized();
  const auto at = [&](double dx, double dy) {
    return PointAlong(options, ray / ray.z() + Eigen::Vector3d(dx, dy, 0.0), random);
  };
  const Eigen::Vector3d normal = (at(0.0, kStep) - at(0.0, -kStep)).cross(at(kStep, 0.0) - at(-kStep, 0.0));
  return normal.normalized();
}

// A point of the surface after so many seconds.
inline Eigen::Vector3d Moved(const SceneWave& wave, const Eigen::Vector3d& point, double seconds) {
  const double phase = 2.0 * std::numbers::pi / wave.wavelength_mm * point.sum();
  const double dy = wave.amplitude_mm * (std::sin(wave.omega_rad_s * seconds + phase) - std::sin(phase));
  return point + Eigen::Vector3d(0.0, dy, 0.0);
}

// Lambert's law for a light at the camera that falls off with the square of the distance and reaches full scale at
// 10 mm, through a response of gamma 2.2; `log_albedo` counts like a log distance.
inline double BrightnessOf(const Eigen::Vector3d& point_in_cam, const Eigen::Vector3d& normal_in_cam,
                           double log_albedo) {
  constexpr double kFullScaleMm = 10.0;
  constexpr double kGamma = 2.2;
  const double cosine = -normal_in_cam.dot(point_in_cam.normalized());
  if (cosine <= 0.0 || point_in_cam.z() <= 0.0) return 0.0;
  const double intensity = cosine * std::pow(kFullScaleMm / point_in_cam.norm() * std::exp(-log_albedo), 2);
  return 255.0 * std::pow(std::min(intensity, 1.0), 1.0 / kGamma);
}

inline Rigid3 PoseAt(const SceneOptions& options, double fraction, double baseline_mm) {
  const double angle = fraction * options.rotation_deg * std::numbers::pi / 180.0;
  const Eigen::Quaterniond rotation = RotationExp(angle * Eigen::Vector3d(0.3, 0.8, 0.5).normalized());
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  if (options.motion == Motion::kForward)
    center = fraction * baseline_mm * Eigen::Vector3d(0.05, 0.02, 1.0).normalized();
  if (options.motion == Motion::kSideways)
    center = fraction * baseline_mm * Eigen::Vector3d(1.0, 0.1, 0.1).normalized();
  if (options.motion == Motion::kStill) return {};
  return {rotation, rotation * -center};
}

inline double MedianParallax(const SceneOptions& options, const std::vector<Eigen::Vector3d>& points,
                             double baseline_mm) {
  const Eigen::Vector3d center = PoseAt(options, 1.0, baseline_mm).OriginInSource();
  std::vector<double> angles;
  for (const Eigen::Vector3d& x : points) {
    const Eigen::Vector3d y = x - center;
    angles.push_back(std::atan2(x.cross(y).norm(), x.dot(y)));
  }
  std::nth_element(angles.begin(), angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 2), angles.end());
  return angles[angles.size() / 2] * 180.0 / std::numbers::pi;
}

// The baseline of the wanted median parallax, by bisection, at most 15 mm: farther forwards, near points fall behind.
inline double Baseline(const SceneOptions& options, const std::vector<Eigen::Vector3d>& points) {
  if (options.motion == Motion::kRotation || options.motion == Motion::kStill) return 0.0;
  if (options.baseline_mm) return *options.baseline_mm;
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
  Random albedo = root.Child("albedo");
  const Eigen::Vector2d center(0.5 * (options.width - 1), 0.5 * (options.height - 1));

  Scene scene;
  std::vector<Eigen::Vector3d> normals;
  std::vector<double> log_albedos;
  for (int i = 0; i < options.num_points; ++i) {
    const Eigen::Vector2d pixel(place.Uniform(0, options.width - 1), place.Uniform(0, options.height - 1));
    const Eigen::Vector3d ray = ((pixel - center) / options.focal_px).homogeneous();
    scene.points.push_back(internal::PointAlong(options, ray, &place));
    normals.push_back(internal::NormalAlong(options, ray, &place));
    log_albedos.push_back(albedo.Normal(options.light_sigma));
    scene.is_outlier.push_back(outlier.Uniform() < options.outlier_share ? 1 : 0);
  }
  const double baseline_mm = internal::Baseline(options, scene.points);
  for (int k = 0; k < options.num_frames; ++k) {
    const double fraction = options.num_frames > 1 ? static_cast<double>(k) / (options.num_frames - 1) : 0.0;
    const Rigid3 cam_from_world = internal::PoseAt(options, fraction, baseline_mm);
    auto& pixels = scene.pixels.emplace_back();
    auto& brightness = scene.brightness.emplace_back();
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      const Eigen::Vector3d x =
          cam_from_world * internal::Moved(options.wave, scene.points[i], fraction * options.wave.seconds);
      Eigen::Vector2d pixel = options.focal_px * x.hnormalized() + center;
      if (x.z() <= 0.0) pixel.setConstant(std::numeric_limits<double>::quiet_NaN());
      if (k > 0 && scene.is_outlier[i] != 0)
        pixel = {outlier.Uniform(0, options.width - 1), outlier.Uniform(0, options.height - 1)};
      const double dx = noise.Normal();
      const double dy = noise.Normal();
      pixels.emplace_back(pixel + options.noise_px * Eigen::Vector2d(dx, dy));
      brightness.push_back(internal::BrightnessOf(x, cam_from_world.rotation * normals[i], log_albedos[i]));
    }
    scene.cams_from_world.push_back(cam_from_world);
  }
  return scene;
}

// Unit rays of one frame of a scene: a pinhole with the scene's focal length, its center in the image's middle.
inline std::vector<Eigen::Vector3d> RaysOf(const Scene& scene, const SceneOptions& options, std::size_t frame) {
  const Eigen::Vector2d center(0.5 * (options.width - 1), 0.5 * (options.height - 1));
  std::vector<Eigen::Vector3d> rays;
  for (const Eigen::Vector2d& pixel : scene.pixels[frame])
    rays.push_back(((pixel - center) / options.focal_px).homogeneous().normalized());
  return rays;
}

}  // namespace pliant::test

template <>
struct pliant::EnumNames<pliant::test::Surface> {
  static constexpr std::array kNames = {std::pair{pliant::test::Surface::kTube, std::string_view("tube")},
                                        std::pair{pliant::test::Surface::kOrgan, std::string_view("organ")},
                                        std::pair{pliant::test::Surface::kPlane, std::string_view("plane")},
                                        std::pair{pliant::test::Surface::kBlob, std::string_view("blob")}};
};

template <>
struct pliant::EnumNames<pliant::test::Motion> {
  static constexpr std::array kNames = {std::pair{pliant::test::Motion::kForward, std::string_view("forward")},
                                        std::pair{pliant::test::Motion::kSideways, std::string_view("sideways")},
                                        std::pair{pliant::test::Motion::kRotation, std::string_view("rotation")},
                                        std::pair{pliant::test::Motion::kStill, std::string_view("still")}};
};
