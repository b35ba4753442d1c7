// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <tbb/parallel_for.h>

#include "simulation/closest_point.h"

namespace pliant::simulation {
namespace {

struct Clearance {
  double distance_mm = std::numeric_limits<double>::infinity();
  bool at_end = false;          // of the tube
  bool passes_through = false;  // the wall, on the way to the next frame
};

class Checker {
 public:
  Checker(const SimulationOptions& options, const Path& path, double tube_mm, const Surface& surface,
          const Motion& motion, const RayScene& at_rest)
      : options_(options), path_(path), tube_mm_(tube_mm), surface_(surface), motion_(motion), at_rest_(at_rest) {
    const double frame_s = 1.0 / options.trajectory.fps;
    const double swell_reach_mm = surface.SwellReachMm();
    displacement_mm_ = motion.LargestDisplacementMm(swell_reach_mm);
    step_mm_ = motion.LargestStepMm(swell_reach_mm, frame_s);
  }

  Clearance At(int frame_idx) const {
    const double time_s = Time(frame_idx);
    const double next_s = Time(std::min(frame_idx + 1, options_.trajectory.frames - 1));
    const Eigen::Vector3d here = path_.WorldFromCamera(time_s).translation;
    const Eigen::Vector3d next = path_.WorldFromCamera(next_s).translation;
    Clearance clearance;
    clearance.at_end = AtEnd(here, time_s);
    const double way_mm = (next - here).norm() + step_mm_;
    const double reach_mm = std::max(options_.trajectory.clearance_mm, way_mm) + displacement_mm_;
    at_rest_.VisitNear(here, reach_mm, [&](std::uint32_t idx) {
      const Corners wall = Posed(idx, time_s);
      const double distance_mm = (ClosestPoint(wall, here) - here).norm();
      clearance.distance_mm = std::min(clearance.distance_mm, distance_mm);
      if (distance_mm > way_mm || next_s == time_s) return;
      // Seen from the wall: its own motion is taken off the camera's.
      const Corners later = Posed(idx, next_s);
      const Eigen::Vector3d moved = (later[0] - wall[0] + later[1] - wall[1] + later[2] - wall[2]) / 3.0;
      if (CrossesTriangle(wall, here, next - moved)) clearance.passes_through = true;
    });
    return clearance;
  }

 private:
  double Time(int frame_idx) const { return frame_idx / options_.trajectory.fps; }

  Corners Posed(std::uint32_t triangle_idx, double time_s) const {
    const auto& t = surface_.triangles[triangle_idx];
    const auto corner = [&](int i) { return motion_.Position(surface_.VertexAtRest(t[i]), time_s); };
    return {corner(0), corner(1), corner(2)};
  }

  // Beyond the far end, or out of the open one at the origin.
  bool AtEnd(const Eigen::Vector3d& center, double time_s) const {
    if (options_.scene.kind != SceneKind::kColon && options_.scene.kind != SceneKind::kTube) return false;
    constexpr double kOutsideMm = 5.0;  // more than a tremor before the opening
    if (center.z() < -kOutsideMm && center.norm() < 3.0 * options_.scene.radius_mm) return true;
    const auto position_mm = path_.PositionMm(time_s);
    return position_mm && *position_mm >= tube_mm_;
  }

  const SimulationOptions& options_;
  const Path& path_;
  double tube_mm_;
  const Surface& surface_;
  const Motion& motion_;
  const RayScene& at_rest_;
  double displacement_mm_;
  double step_mm_;
};

// What the first camera sees: a camera that starts on the right side stays there unless it passes through the wall.
Status CheckFirstView(const Surface& surface, const RayScene& at_rest, const Eigen::Vector3d& center,
                      std::span<const Eigen::Vector3d> first_view) {
  std::vector<RayHit> hits(first_view.size());
  at_rest.Intersect(center, first_view, hits);
  int inner = 0;
  int outer = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (!hits[i].hit()) continue;
    const auto& t = surface.triangles[hits[i].point.triangle_idx];
    const Eigen::Vector3f normal = surface.normals[t[0]] + surface.normals[t[1]] + surface.normals[t[2]];
    ++(normal.cast<double>().dot(first_view[i]) < 0 ? inner : outer);
  }
  if (inner + outer == 0)
    return {ErrorCode::kInvalidArgument,
            "the camera of frame 0 sees nothing of the scene; check Trajectory.start_pose or Trajectory.path (poses "
            "are world_from_camera in mm) and Scene.mesh_scale"};
  if (inner < outer)
    return {ErrorCode::kInvalidArgument,
            "the camera of frame 0 has left the lumen and sees the wall from outside; check Trajectory.start_pose or "
            "Trajectory.path"};
  return Status::Ok();
}

}  // namespace

Status CheckClearance(const SimulationOptions& options, const Path& path, double tube_mm, const Surface& surface,
                      const Motion& motion, const RayScene& at_rest, std::span<const Eigen::Vector3d> first_view) {
  const Checker checker(options, path, tube_mm, surface, motion, at_rest);
  std::vector<Clearance> clearances(static_cast<std::size_t>(options.trajectory.frames));
  tbb::parallel_for(0, options.trajectory.frames,
                    [&](int frame_idx) { clearances[frame_idx] = checker.At(frame_idx); });
  const double least_mm = options.trajectory.clearance_mm;
  const std::string advice =
      "; change the Trajectory options, lower the folds or the deformation, or make the scene wider";
  for (std::size_t i = 0; i < clearances.size(); ++i) {
    const std::string camera_of_frame = "the camera of frame " + std::to_string(i);
    if (clearances[i].at_end) return {ErrorCode::kInvalidArgument, camera_of_frame + " has left the lumen" + advice};
    if (clearances[i].distance_mm < least_mm)
      return {ErrorCode::kInvalidArgument,
              camera_of_frame + " is " + FormatDouble(std::round(100.0 * clearances[i].distance_mm) / 100.0) +
                  " mm from the wall, and Trajectory.clearance_mm is " + FormatDouble(least_mm) + advice};
    if (i == 0)
      if (Status status = CheckFirstView(surface, at_rest, path.WorldFromCamera(0).translation, first_view);
          !status.ok())
        return status;
    if (clearances[i].passes_through)
      return {ErrorCode::kInvalidArgument,
              camera_of_frame + " passes through the wall on its way to the next frame" + advice};
  }
  return Status::Ok();
}

}  // namespace pliant::simulation
