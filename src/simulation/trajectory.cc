// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/trajectory.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pliant/base/random.h"
#include "pliant/base/text.h"
#include "simulation/board_views.h"

namespace pliant::simulation {
namespace {

// A camera at `center` that looks at `target`, its y axis as near to `down` as that allows.
Rigid3 LookAt(const Eigen::Vector3d& center, const Eigen::Vector3d& target, const Eigen::Vector3d& down) {
  const Eigen::Vector3d z = (target - center).normalized();
  const Eigen::Vector3d x = down.cross(z).normalized();
  Eigen::Matrix3d world_from_camera;
  world_from_camera << x, z.cross(x), z;
  return {world_from_camera, center};
}

Result<Rigid3> ParsePose(const std::string& text) {
  const auto numbers = ParseNumbers(text);
  const Eigen::Vector4d q =
      numbers && numbers->size() == 7 ? Eigen::Vector4d(numbers->data() + 3) : Eigen::Vector4d(Eigen::Vector4d::Zero());
  if (std::abs(q.norm() - 1.0) > 0.01)
    return {ErrorCode::kInvalidArgument,
            "Trajectory.start_pose is '" + text + "'; give tx,ty,tz,qx,qy,qz,qw with a quaternion of unit length"};
  return Rigid3(Eigen::Quaterniond(q[3], q[0], q[1], q[2]), Eigen::Vector3d(numbers->data()));
}

// The poses with times from 0 on, long enough for the frames.
Result<std::vector<TimedPose>> ReadPath(const SimulationOptions::Trajectory& options) {
  if (options.path.empty())
    return {ErrorCode::kInvalidArgument, "Trajectory.kind file needs Trajectory.path, a file of TUM lines"};
  auto poses = ReadTumTrajectory(options.path);
  if (!poses.ok()) return poses.status();
  if (poses->empty()) return {ErrorCode::kInsufficient, "the camera path " + options.path + " has no pose in it"};
  constexpr double kFarthestMm = 1e6;  // beyond it a float, with which rays are cast, has no tenths
  for (const TimedPose& pose : *poses)
    if (!(pose.world_from_cam.translation.norm() < kFarthestMm))
      return {ErrorCode::kInvalidArgument,
              "the camera path " + options.path + " has a pose more than 1 km from the origin; is its unit mm?"};
  const double first_s = poses->front().timestamp_s;
  for (TimedPose& pose : *poses) pose.timestamp_s -= first_s;
  const double last_frame_s = (options.frames - 1) / options.fps;
  // Times are written to a microsecond.
  constexpr double kRoundingS = 2e-6;
  if (poses->back().timestamp_s + kRoundingS < last_frame_s)
    return {ErrorCode::kInsufficient,
            "the camera path " + options.path + " lasts " + FormatDouble(poses->back().timestamp_s) + " s, and " +
                std::to_string(options.frames) + " frames at " + FormatDouble(options.fps) + " 1/s need " +
                FormatDouble(last_frame_s) + " s; lower Trajectory.frames or give a longer path"};
  return poses;
}

}  // namespace

double LastCameraMm(const SimulationOptions::Trajectory& options) {
  if (options.kind == TrajectoryKind::kLoop) return options.start_mm + options.loop_length_mm;
  if (options.kind != TrajectoryKind::kInsert) return options.start_mm;
  return options.start_mm + options.speed_mm_s * (options.frames - 1) / options.fps;
}

Path::Path(const SimulationOptions& options)
    : options_(options.trajectory), scene_(options.scene.kind), radius_mm_(options.scene.radius_mm) {
  Random random = Random(static_cast<std::uint64_t>(options.scene.seed)).Child("tremor");
  for (auto& axis : tremor_) {
    double power = 0;
    for (Wave& wave : axis) {
      wave = {random.Uniform(0.15, 1.6), random.Uniform(0, 2 * std::numbers::pi), 0};
      // A hand's tremor is slow where it is large.
      wave.weight = 1.0 / (0.3 + wave.frequency_hz);
      power += 0.5 * wave.weight * wave.weight;
      // A closed path is closed to the tremor.
      if (options_.kind == TrajectoryKind::kLoop)
        wave.frequency_hz = std::max(1.0, std::round(wave.frequency_hz * LoopPeriodS())) / LoopPeriodS();
    }
    for (Wave& wave : axis) wave.weight /= std::sqrt(power);
  }
}

Result<Path> Path::Create(const SimulationOptions& options) {
  Path path(options);
  const SimulationOptions::Trajectory& trajectory = options.trajectory;
  if (trajectory.kind == TrajectoryKind::kFile) {
    auto poses = ReadPath(trajectory);
    if (!poses.ok()) return poses.status();
    path.poses_ = *std::move(poses);
    return path;
  }
  if (trajectory.kind == TrajectoryKind::kBoard) {
    auto views = BoardViews(options);
    if (!views.ok()) return views.status();
    path.views_ = *std::move(views);
    return path;
  }
  if (!trajectory.start_pose.empty()) {
    auto pose = ParsePose(trajectory.start_pose);
    if (!pose.ok()) return pose.status();
    path.start_ = *pose;
  } else if (options.scene.kind == SceneKind::kMesh) {
    return {ErrorCode::kInvalidArgument,
            "a mesh does not say where its camera starts; give Trajectory.start_pose, or Trajectory.kind file with "
            "Trajectory.path"};
  } else if (options.scene.kind == SceneKind::kBoard) {
    return {ErrorCode::kInvalidArgument,
            "a board has no path of its own for a camera; give Trajectory.kind board, or Trajectory.start_pose"};
  }
  return path;
}

bool Path::InTube() const { return scene_ == SceneKind::kColon || scene_ == SceneKind::kTube; }

double Path::LoopPeriodS() const {
  if (options_.loop_period_s > 0) return options_.loop_period_s;
  return std::max(options_.frames - 1, 1) / options_.fps;
}

double Path::ReachMm() const {
  if (poses_.empty() && !start_) return LastCameraMm(options_);
  double farthest = start_ ? start_->translation.norm() + LastCameraMm(options_) : 0.0;
  for (const TimedPose& pose : poses_) farthest = std::max(farthest, pose.world_from_cam.translation.norm());
  // A way that bends is longer than the straight line.
  constexpr double kBend = 1.25;
  return kBend * farthest;
}

std::optional<double> Path::PositionMm(double time_s) const {
  if (!InTube() || start_ || options_.kind == TrajectoryKind::kFile) return std::nullopt;
  return options_.start_mm + AdvanceMm(time_s);
}

double Path::AdvanceMm(double time_s) const {
  if (options_.kind == TrajectoryKind::kInsert) return options_.speed_mm_s * time_s;
  if (options_.kind != TrajectoryKind::kLoop) return 0.0;
  return 0.5 * options_.loop_length_mm * (1.0 - std::cos(2.0 * std::numbers::pi * time_s / LoopPeriodS()));
}

Rigid3 Path::Steady(double advance_mm) const {
  if (start_) return *start_ * Rigid3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0, 0, advance_mm));
  const double s_mm = options_.start_mm + advance_mm;
  if (!InTube()) {
    const Eigen::Vector3d looked_at(0.0, options_.height_mm, s_mm + options_.look_ahead_mm);
    return LookAt({0.0, 0.0, s_mm}, looked_at, Eigen::Vector3d::UnitY());
  }
  const Rigid3 world_from_frame = centerline_->WorldFromFrame(s_mm);
  const Rigid3 ahead = centerline_->WorldFromFrame(s_mm + options_.look_ahead_mm);
  return LookAt(world_from_frame.translation, ahead.translation, world_from_frame.rotation * Eigen::Vector3d::UnitY());
}

Rigid3 Path::Sway(double time_s) const {
  // In a tube: about a point of the wall ahead, seen from the centerline. Else: about what the steady camera looks at.
  const Rigid3 steady = Steady(0.0);
  const Eigen::Vector3d middle = steady.translation;
  Eigen::Vector3d target;
  Eigen::Vector3d down;
  if (start_) {
    target = steady * Eigen::Vector3d(0.0, 0.0, options_.sway_distance_mm);
    down = steady.rotation * Eigen::Vector3d::UnitY();
  } else if (InTube()) {
    const Rigid3 ahead = centerline_->WorldFromFrame(options_.start_mm + options_.sway_distance_mm);
    target = ahead * Eigen::Vector3d(0.0, 0.6 * radius_mm_, 0.0);
    down = centerline_->WorldFromFrame(options_.start_mm).rotation * Eigen::Vector3d::UnitY();
  } else {
    target = steady * Eigen::Vector3d(0.0, 0.0, std::hypot(options_.height_mm, options_.look_ahead_mm));
    down = steady.rotation * Eigen::Vector3d::UnitY();
  }
  // An arc about the target: what is looked at keeps its distance.
  const double distance = (target - middle).norm();
  const double angle =
      options_.sway_amplitude_mm / distance * std::sin(2.0 * std::numbers::pi * time_s / options_.sway_period_s);
  const Eigen::AngleAxisd turn(angle, down);
  return LookAt(target + turn * (middle - target), target, down);
}

Rigid3 Path::Loop(double time_s) const {
  // Out on one side and back on the other: an ellipse whose ends lie on the way.
  const double phase = 2.0 * std::numbers::pi * time_s / LoopPeriodS();
  const Eigen::Vector3d aside(options_.loop_width_mm * std::sin(phase), 0.0, 0.0);
  return Steady(AdvanceMm(time_s)) * Rigid3(Eigen::Quaterniond::Identity(), aside);
}

Rigid3 Path::FromFile(double time_s) const {
  const auto after = std::upper_bound(poses_.begin(), poses_.end(), time_s,
                                      [](double time, const TimedPose& pose) { return time < pose.timestamp_s; });
  if (after == poses_.begin()) return poses_.front().world_from_cam;
  if (after == poses_.end()) return poses_.back().world_from_cam;
  const TimedPose& a = *(after - 1);
  const TimedPose& b = *after;
  return Interpolated(a.world_from_cam, b.world_from_cam, (time_s - a.timestamp_s) / (b.timestamp_s - a.timestamp_s));
}

Rigid3 Path::AmongViews(double time_s) const {
  const double at = std::clamp(time_s / options_.view_s, 0.0, static_cast<double>(views_.size() - 1));
  const auto before = std::min(static_cast<std::size_t>(at), views_.size() - 2);
  const double share = at - static_cast<double>(before);
  // Without speed at either end.
  return Interpolated(views_[before], views_[before + 1], share * share * (3.0 - 2.0 * share));
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
      world_from_steady = Steady(AdvanceMm(time_s));
      break;
    case TrajectoryKind::kSway:
      world_from_steady = Sway(time_s);
      break;
    case TrajectoryKind::kHold:
      world_from_steady = Steady(0.0);
      break;
    case TrajectoryKind::kLoop:
      world_from_steady = Loop(time_s);
      break;
    case TrajectoryKind::kFile:
      return FromFile(time_s);
    case TrajectoryKind::kBoard:
      world_from_steady = AmongViews(time_s);
      break;
  }
  return world_from_steady * Tremor(time_s);
}

}  // namespace pliant::simulation
