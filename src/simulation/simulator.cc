// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/simulation/simulator.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "simulation/centreline.h"
#include "simulation/motion.h"
#include "simulation/ray_scene.h"
#include "simulation/renderer.h"
#include "simulation/surface.h"
#include "simulation/trajectory.h"

namespace pliant {

using simulation::RayHit;

struct Simulator::State {
  State(SimulationOptions o, Camera c, double length_mm)
      : options(std::move(o)),
        camera(std::move(c)),
        arena(options.threads == 0 ? tbb::task_arena::automatic : options.threads),
        centreline(length_mm, options.scene.bend_deg_per_cm, options.scene.seed),
        motion(options.deformation),
        path(options.trajectory, options.scene.radius_mm, options.scene.seed, centreline),
        surface(arena.execute([&] { return simulation::MakeTube(options.scene, centreline, length_mm); })),
        posed_vertices(surface.vertices),
        posed_normals(surface.normals) {}

  double Time(int frame_idx) const { return frame_idx / options.trajectory.fps; }
  Rigid3 WorldFromCamera(int frame_idx) const { return path.WorldFromCamera(Time(frame_idx)); }
  Eigen::Vector3d RestPosition(const MaterialPoint& point) const;
  Eigen::Vector3d Position(const MaterialPoint& point, double time_s) const {
    return motion.Position(RestPosition(point), time_s);
  }

  Status CheckClearance() const;
  // Made when the first frame is rendered: truth does without.
  const simulation::Renderer& GetRenderer();
  void Pose(int frame_idx);

  SimulationOptions options;
  Camera camera;
  tbb::task_arena arena;
  simulation::Centreline centreline;
  simulation::Motion motion;
  simulation::Path path;
  simulation::Surface surface;
  std::vector<Eigen::Vector3f> posed_vertices;
  std::vector<Eigen::Vector3f> posed_normals;
  std::optional<simulation::RayScene> scene;
  std::unique_ptr<simulation::Renderer> renderer;
  int posed_frame_idx = -1;  // -1: at rest
};

namespace {

// Scenes and cameras that no memory holds are refused before it is asked for.
Status CheckMemory(const SimulationOptions& options, double length_mm) {
  constexpr double kMostTexels = 4e8;
  const double texels = 2 * 3.1416 * options.scene.radius_mm * 1.5 * length_mm /
                        std::min(options.texture.texel_mm * options.texture.texel_mm,
                                 options.scene.mesh_step_mm * options.scene.mesh_step_mm / 8);
  if (texels > kMostTexels)
    return {ErrorCode::kInvalidArgument,
            "a wall " + FormatDouble(std::round(length_mm)) +
                " mm long does not fit into memory at this resolution; shorten the way, or raise Texture.texel_mm and "
                "Scene.mesh_step_mm"};
  constexpr double kMostRays = 4e8;
  const double rays = static_cast<double>(options.camera.width) * options.camera.height * (options.sensor.samples + 1);
  if (rays > kMostRays)
    return {ErrorCode::kInvalidArgument, "the rays of " + std::to_string(options.camera.width) + "x" +
                                             std::to_string(options.camera.height) +
                                             " pixels do not fit into memory with Sensor.samples " +
                                             std::to_string(options.sensor.samples) + "; lower one of them"};
  return Status::Ok();
}

struct Clearance {
  double distance_mm = std::numeric_limits<double>::infinity();
  bool inside = true;
};

// The vertex nearest to the camera, and whether the camera is on its inner side.
Clearance NearestWall(const simulation::Surface& surface, const simulation::Motion& motion, double reach_mm,
                      const Eigen::Vector3d& centre, double time_s) {
  Clearance nearest;
  const Eigen::Vector3f centre_f = centre.cast<float>();
  // Every second vertex each way: a wall that is smooth over the mesh does not hide between them.
  for (int row = 0; row < surface.rows; row += 2) {
    for (int column = 0; column < surface.columns; column += 2) {
      const std::size_t idx = static_cast<std::size_t>(row) * surface.columns + column;
      if ((surface.vertices[idx] - centre_f).squaredNorm() > reach_mm * reach_mm) continue;
      const Eigen::Vector3d at_rest = surface.vertices[idx].cast<double>();
      const Eigen::Vector3d to_camera = centre - motion.Position(at_rest, time_s);
      if (to_camera.norm() >= nearest.distance_mm) continue;
      nearest.distance_mm = to_camera.norm();
      nearest.inside = to_camera.dot(motion.Normal(surface.normals[idx].cast<double>(), at_rest, time_s)) > 0;
    }
  }
  return nearest;
}

}  // namespace

Status Simulator::State::CheckClearance() const {
  const double least_mm = options.trajectory.clearance_mm;
  const double reach_mm = 1.5 * options.scene.radius_mm + options.deformation.amplitude_mm + least_mm;
  std::vector<Clearance> clearances(static_cast<std::size_t>(options.trajectory.frames));
  tbb::parallel_for(0, options.trajectory.frames, [&](int frame_idx) {
    clearances[frame_idx] =
        NearestWall(surface, motion, reach_mm, WorldFromCamera(frame_idx).translation, Time(frame_idx));
  });
  for (std::size_t i = 0; i < clearances.size(); ++i) {
    const std::string camera_of_frame = "the camera of frame " + std::to_string(i);
    const std::string advice =
        "; change the Trajectory options, lower Scene.fold_depth_mm or Deformation.amplitude_mm, or widen "
        "Scene.radius_mm";
    // Beyond reach of any wall is outside too: the camera has passed an end of the tube.
    if (!clearances[i].inside || std::isinf(clearances[i].distance_mm))
      return {ErrorCode::kInvalidArgument, camera_of_frame + " has left the lumen" + advice};
    if (clearances[i].distance_mm < least_mm)
      return {ErrorCode::kInvalidArgument,
              camera_of_frame + " is " + FormatDouble(std::round(100.0 * clearances[i].distance_mm) / 100.0) +
                  " mm from the wall, and Trajectory.clearance_mm is " + FormatDouble(least_mm) + advice};
  }
  return Status::Ok();
}

const simulation::Renderer& Simulator::State::GetRenderer() {
  if (!renderer) {
    if (posed_frame_idx != -1) scene->Move(surface.vertices);
    posed_frame_idx = -1;
    simulation::Motions motions;
    motions.world_from_cam = [this](double time_s) { return path.WorldFromCamera(time_s); };
    if (!motion.rigid())
      motions.position = [this](const MaterialPoint& point, double time_s) { return Position(point, time_s); };
    renderer = std::make_unique<simulation::Renderer>(options, camera, surface, *scene, std::move(motions));
  }
  return *renderer;
}

void Simulator::State::Pose(int frame_idx) {
  assert(frame_idx >= 0 && frame_idx < options.trajectory.frames);
  if (motion.rigid() || posed_frame_idx == frame_idx) return;
  const double time_s = Time(frame_idx);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, surface.vertices.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const Eigen::Vector3d at_rest = surface.vertices[i].cast<double>();
      posed_vertices[i] = motion.Position(at_rest, time_s).cast<float>();
      posed_normals[i] = motion.Normal(surface.normals[i].cast<double>(), at_rest, time_s).cast<float>();
    }
  });
  scene->Move(posed_vertices);
  posed_frame_idx = frame_idx;
}

Simulator::Simulator(std::unique_ptr<State> state) : state_(std::move(state)) {}
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;
Simulator::~Simulator() = default;

Result<Simulator> Simulator::Create(const SimulationOptions& options) {
  SimulationOptions checked = options;
  OptionTable table;
  checked.List(table);
  for (const OptionField& field : table.fields())
    if (Status status = field.set(field.get()); !status.ok()) return status;
  Result<Camera> camera = SimulatedCamera(options);
  if (!camera.ok()) return camera.status();
  if (options.camera.baseline_mm > 0 && options.camera.model != CameraModelId::kPinhole &&
      options.camera.model != CameraModelId::kSimplePinhole)
    return {ErrorCode::kInvalidArgument,
            "Camera.baseline_mm makes rectified pairs, which only PINHOLE and SIMPLE_PINHOLE cameras give, and "
            "Camera.model is " +
                std::string(EnumName(options.camera.model))};
  if (options.sensor.shutter_s * options.trajectory.fps > 1.0)
    return {ErrorCode::kInvalidArgument, "Sensor.shutter_s is " + FormatDouble(options.sensor.shutter_s) +
                                             ", longer than a frame at " + FormatDouble(options.trajectory.fps) +
                                             " frames a second; shorten it"};

  const double needed_mm = simulation::LastCameraMm(options.trajectory) + options.scene.view_mm;
  const double length_mm = options.scene.length_mm > 0 ? options.scene.length_mm : needed_mm;
  if (Status status = CheckMemory(options, length_mm); !status.ok()) return status;

  auto state = std::make_unique<State>(options, *std::move(camera), length_mm);
  Status status;
  state->arena.execute([&] {
    status = state->CheckClearance();
    if (!status.ok()) return;
    using Vertices = simulation::RayScene::Vertices;
    auto scene =
        simulation::RayScene::Create(state->surface, state->motion.rigid() ? Vertices::kFixed : Vertices::kMoving);
    if (!scene.ok()) {
      status = scene.status();
      return;
    }
    state->scene = *std::move(scene);
  });
  if (!status.ok()) return status;
  return Simulator(std::move(state));
}

const SimulationOptions& Simulator::options() const { return state_->options; }
const Camera& Simulator::camera() const { return state_->camera; }
Rigid3 Simulator::WorldFromCamera(int frame_idx, Eye eye) const {
  const Rigid3 world_from_left = state_->WorldFromCamera(frame_idx);
  return eye == Eye::kLeft ? world_from_left : simulation::RightCamera(world_from_left, options().camera.baseline_mm);
}

Eigen::Vector3d Simulator::RestPosition(const MaterialPoint& point) const { return state_->RestPosition(point); }

Eigen::Vector3d Simulator::State::RestPosition(const MaterialPoint& point) const {
  const auto& t = surface.triangles[point.triangle_idx];
  const auto& v = surface.vertices;
  return (1.0 - point.b1 - point.b2) * v[t[0]].cast<double>() + point.b1 * v[t[1]].cast<double>() +
         point.b2 * v[t[2]].cast<double>();
}

Eigen::Vector3d Simulator::Position(const MaterialPoint& point, int frame_idx) const {
  return state_->Position(point, TimeOf(frame_idx));
}

std::vector<std::optional<SurfaceHit>> Simulator::HitsAt(int frame_idx, std::span<const Eigen::Vector2d> pixels,
                                                         Eye eye) {
  state_->arena.execute([&] { state_->Pose(frame_idx); });
  const Rigid3 world_from_cam = WorldFromCamera(frame_idx, eye);
  const auto rays_in_cam = camera().Unproject(pixels);
  std::vector<Eigen::Vector3d> directions;
  for (const auto& ray : rays_in_cam)
    directions.push_back(ray ? world_from_cam.rotation * *ray : Eigen::Vector3d(Eigen::Vector3d::Zero()));
  std::vector<RayHit> hits(pixels.size());
  state_->scene->Intersect(world_from_cam.translation, directions, hits);
  std::vector<std::optional<SurfaceHit>> answers(pixels.size());
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (!hits[i].hit()) continue;
    answers[i] = SurfaceHit{hits[i].point, world_from_cam.translation + hits[i].distance_mm * directions[i],
                            hits[i].distance_mm * rays_in_cam[i]->z()};
  }
  return answers;
}

std::vector<MaterialObservation> Simulator::Observe(int frame_idx, std::span<const MaterialPoint> points, Eye eye) {
  // Longer than the rounding of the rays and the chord of a moved triangle, shorter than any fold.
  constexpr double kSameMm = 0.02;
  state_->arena.execute([&] { state_->Pose(frame_idx); });
  const Rigid3 world_from_cam = WorldFromCamera(frame_idx, eye);
  const Rigid3 cam_from_world = world_from_cam.Inverse();
  std::vector<MaterialObservation> observations(points.size());
  std::vector<Eigen::Vector3d> directions(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    MaterialObservation& seen = observations[i];
    seen.point_in_world = Position(points[i], frame_idx);
    const Eigen::Vector3d point_in_cam = cam_from_world * seen.point_in_world;
    seen.depth_mm = point_in_cam.z();
    directions[i] = (seen.point_in_world - world_from_cam.translation).normalized();
    const auto pixel = camera().Project(point_in_cam);
    if (!pixel) continue;
    seen.pixel = *pixel;
    if (camera().Contains(*pixel)) seen.visibility = Visibility::kVisible;
  }
  std::vector<RayHit> hits(points.size());
  state_->scene->Intersect(world_from_cam.translation, directions, hits);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double distance = (observations[i].point_in_world - world_from_cam.translation).norm();
    if (observations[i].visibility == Visibility::kVisible && hits[i].hit() && hits[i].distance_mm < distance - kSameMm)
      observations[i].visibility = Visibility::kOccluded;
  }
  return observations;
}

void Simulator::PrepareRendering() {
  state_->arena.execute([&] { state_->GetRenderer(); });
}

SimulatedFrame Simulator::Render(int frame_idx) {
  SimulatedFrame frame;
  state_->arena.execute([&] {
    const simulation::Renderer& renderer = state_->GetRenderer();
    state_->Pose(frame_idx);
    frame = renderer.Render(frame_idx, *state_->scene, state_->posed_normals);
  });
  return frame;
}

}  // namespace pliant
