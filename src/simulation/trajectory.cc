// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/trajectory.h"

#include <cmath>
#include <numbers>

#include "pliant/base/random.h"

namespace pliant::simulation {
namespace {

// A camera at `centre` that looks at `target`, its y axis as near to `down` as that allows.
Rigid3 LookAt(const Eigen::Vector3d& centre, const Eigen::Vector3d& target, const Eigen::Vector3d& down) {
  const Eigen::Vector3d z = (target - centre).normalized();
  const Eigen::Vector3d x = down.cross(z).normalized();
  Eigen::Matrix3d world_from_camera;
  world_from_camera << x, z.cross(x), z;
  return {world_from_camera, centre};
}

}  // namespace

double LastCameraMm(const SimulationOptions::Trajectory& options) {
  if (options.kind != TrajectoryKind::kInsert) return options.start_mm;
  return options.start_mm + options.speed_mm_s * (options.frames - 1) / options.fps;
}

Path::Path(const SimulationOptions::Trajectory& options, double radius_mm, int seed, const Centreline& centreline)
    : options_(options), radius_mm_(radius_mm), centreline_(centreline) {
  Random random = Random(static_cast<std::uint64_t>(seed)).Child("tremor");
  for (auto& axis : tremor_) {
    double power = 0;
    for (Wave& wave : axis) {
      wave = {random.Uniform(0.15, 1.6), random.Uniform(0, 2 * std::numbers::pi), 0};
      // A hand's tremor is slow where it is large.
      wave.weight = 1.0 / (0.3 + wave.frequency_hz);
      power += 0.5 * wave.weight * wave.weight;
    }
    for (Wave& wave : axis) wave.weight /= std::sqrt(power);
  }
}

Rigid3 Path::Follow(double s_mm) const {
  const Rigid3 world_from_frame = centreline_.WorldFromFrame(s_mm);
  const Rigid3 ahead = centreline_.WorldFromFrame(s_mm + options_.look_ahead_mm);
  return LookAt(world_from_frame.translation, ahead.translation, world_from_frame.rotation * Eigen::Vector3d::UnitY());
}

Rigid3 Path::Sway(double time_s) const {
  const Rigid3 world_from_frame = centreline_.WorldFromFrame(options_.start_mm);
  const Rigid3 ahead = centreline_.WorldFromFrame(options_.start_mm + options_.sway_distance_mm);
  const Eigen::Vector3d target = ahead * Eigen::Vector3d(0.0, 0.6 * radius_mm_, 0.0);
  const Eigen::Vector3d middle = world_from_frame.translation;
  const Eigen::Vector3d down = world_from_frame.rotation * Eigen::Vector3d::UnitY();
  // An arc about the target: what is looked at keeps its distance.
  const double distance = (target - middle).norm();
  const double angle =
      options_.sway_amplitude_mm / distance * std::sin(2.0 * std::numbers::pi * time_s / options_.sway_period_s);
  const Eigen::AngleAxisd turn(angle, down);
  return LookAt(target + turn * (middle - target), target, down);
}

Rigid3 Path::Tremor(double time_s) const {
  Eigen::Matrix<double, 6, 1> value;
  for (int i = 0; i < 6; ++i) {
    value[i] = 0;
    for (const Wave& wave : tremor_[i])
      value[i] += wave.weight * std::sin(2.0 * std::numbers::pi * wave.frequency_hz * time_s + wave.phase);
  }
  const double rad = options_.tremor_deg * std::numbers::pi / 180.0;
  return {RotationExp(rad * value.head<3>()), options_.tremor_mm * value.tail<3>()};
}

Rigid3 Path::WorldFromCamera(double time_s) const {
  Rigid3 world_from_steady;
  switch (options_.kind) {
    case TrajectoryKind::kInsert:
      world_from_steady = Follow(options_.start_mm + options_.speed_mm_s * time_s);
      break;
    case TrajectoryKind::kSway:
      world_from_steady = Sway(time_s);
      break;
    case TrajectoryKind::kHold:
      world_from_steady = Follow(options_.start_mm);
      break;
  }
  return world_from_steady * Tremor(time_s);
}

}  // namespace pliant::simulation
