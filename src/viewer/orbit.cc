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
constexpr double kShare = 0.998;        // of the points that are in the panel for certain
constexpr double kMargin = 1.08;

double Radians(double degrees) { return degrees * std::numbers::pi / 180; }

}  // namespace

Orbit::Orbit(std::span<const Eigen::Vector3d> points, std::span<const Eigen::Vector3d> cameras,
             const Eigen::Quaterniond& world_from_cam, double azimuth_deg, double elevation_deg, double width_px,
             double height_px)
    : width_px_(width_px), height_px_(height_px) {
  // Right, down and ahead of the eye: the camera's, turned to its right and upwards.
  const Eigen::Quaterniond turned = world_from_cam *
                                    Eigen::AngleAxisd(-Radians(azimuth_deg), Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(-Radians(elevation_deg), Eigen::Vector3d::UnitX());
  focal_px_ = 0.5 * std::min(width_px, height_px) / std::tan(Radians(0.5 * kFieldOfViewDeg));
  const Eigen::Vector3d origin = points.front();
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // of the view, in turned axes from the origin
  double distance = 1e-9;                            // of the eye from it
  for (int axis = 0; axis < 2; ++axis) {
    // A point is inside to one side where its offset there is at most slope * its distance along the view.
    const double slope = 0.5 * (axis == 0 ? width_px : height_px) / (kMargin * focal_px_);
    const auto reach = [&](int sign) {
      const auto of = [&](const Eigen::Vector3d& point) {
        const Eigen::Vector3d seen = turned.conjugate() * (point - origin);
        return sign * seen[axis] / slope - seen.z();
      };
      std::vector<double> reaches;
      for (const Eigen::Vector3d& point : points) reaches.push_back(of(point));
      double most = Quantile(std::move(reaches), kShare);
      for (const Eigen::Vector3d& camera : cameras) most = std::max(most, of(camera));
      return most;
    };
    const double low = reach(-1);
    const double high = reach(1);
    middle[axis] = 0.5 * slope * (high - low);
    distance = std::max(distance, 0.5 * (high + low));
  }
  eye_from_world_ = Rigid3{turned, origin + turned * (middle - Eigen::Vector3d(0, 0, distance))}.Inverse();
}

Eigen::Vector3d Orbit::Project(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d seen = eye_from_world_ * point;
  if (!(seen.z() > 0)) return {0, 0, seen.z()};
  return {0.5 * width_px_ + focal_px_ * seen.x() / seen.z(), 0.5 * height_px_ + focal_px_ * seen.y() / seen.z(),
          seen.z()};
}

}  // namespace pliant
