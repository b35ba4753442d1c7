// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/orbit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

constexpr double kFieldOfViewDeg = 40;  // across the smaller side
constexpr double kShare = 0.98;         // of the points that are in the panel for certain
constexpr double kMargin = 1.08;

double Radians(double degrees) { return degrees * std::numbers::pi / 180; }

}  // namespace

Orbit::Orbit(std::span<const Eigen::Vector3d> points, std::span<const Eigen::Vector3d> cameras,
             const Eigen::Quaterniond& world_from_cam, double azimuth_deg, double elevation_deg, double width_px,
             double height_px)
    : width_px_(width_px), height_px_(height_px) {
  Eigen::Vector3d middle;
  for (int i = 0; i < 3; ++i) {
    std::vector<double> values;
    for (const Eigen::Vector3d& point : points) values.push_back(point[i]);
    double low = Quantile(values, 1 - kShare);
    double high = Quantile(values, kShare);
    for (const Eigen::Vector3d& camera : cameras) {
      low = std::min(low, camera[i]);
      high = std::max(high, camera[i]);
    }
    middle[i] = 0.5 * (low + high);
  }
  // Right, down and ahead of the eye: the camera's, turned to its right and upwards.
  const Eigen::Quaterniond turned = world_from_cam *
                                    Eigen::AngleAxisd(-Radians(azimuth_deg), Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(-Radians(elevation_deg), Eigen::Vector3d::UnitX());
  focal_px_ = 0.5 * std::min(width_px, height_px) / std::tan(Radians(0.5 * kFieldOfViewDeg));
  const auto least_distance = [&](const Eigen::Vector3d& point) {  // from which it is just inside
    const Eigen::Vector3d seen = turned.conjugate() * (point - middle);
    const double aside = std::max(std::abs(seen.x()) / (0.5 * width_px), std::abs(seen.y()) / (0.5 * height_px));
    return kMargin * focal_px_ * aside - seen.z();
  };
  std::vector<double> distances;
  for (const Eigen::Vector3d& point : points) distances.push_back(least_distance(point));
  double distance = std::max(1e-9, Quantile(distances, kShare));
  for (const Eigen::Vector3d& camera : cameras) distance = std::max(distance, least_distance(camera));
  const Rigid3 world_from_eye{turned, middle - turned * Eigen::Vector3d(0, 0, distance)};
  eye_from_world_ = world_from_eye.Inverse();
}

Eigen::Vector3d Orbit::Project(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d seen = eye_from_world_ * point;
  if (!(seen.z() > 0)) return {0, 0, seen.z()};
  return {0.5 * width_px_ + focal_px_ * seen.x() / seen.z(), 0.5 * height_px_ + focal_px_ * seen.y() / seen.z(),
          seen.z()};
}

}  // namespace pliant
