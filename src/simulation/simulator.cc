// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/simulation/simulator.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <filesystem>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "pliant/base/text.h"
#include "simulation/centerline.h"
#include "simulation/clearance.h"
#include "simulation/motion.h"
#include "simulation/ray_scene.h"
#include "simulation/recorded_frames.h"
#include "simulation/renderer.h"
#include "simulation/surface.h"
#include "simulation/trajectory.h"

namespace pliant {

using simulation::RayHit;

struct Simulator::State {
  State(SimulationOptions o, Camera c, simulation::Path p)
      : options(std::move(o)),
        camera(std::move(c)),
        arena(options.threads == 0 ? tbb::task_arena::automatic : options.threads),
        path(std::move(p)),
        recorded(simulation::RecordedFrames(options)) {}

  // Of a frame of the recording: the moment that it shows.
  double Time(int frame_idx) const { return recorded[frame_idx].shown_idx / options.trajectory.fps; }
  Rigid3 WorldFromCamera(int frame_idx) const { return path.WorldFromCamera(Time(frame_idx)); }
  Eigen::Vector3d Position(const MaterialPoint& point, double time_s) const {
    return motion.Position(surface.AtRest(point), time_s);
  }

  // Surface, rays, motion, and whether the camera can go its way.
  Status Build(double length_mm);
  Status MakeSurface(double length_mm);
  // Unit rays in the world of a coarse grid of pixels.
  std::vector<Eigen::Vector3d> FirstView() const;
  void TurnNormalsToFirstView();
  Result<simulation::Poke> FindPoke() const;
  void CollectWarnings();
  // Made when the first frame is rendered: truth does without.
  const simulation::Renderer& GetRenderer();
  void Pose(int frame_idx);

  SimulationOptions options;
  Camera camera;
  tbb::task_arena arena;
  simulation::Path path;
  std::vector<simulation::RecordedFrame> recorded;
  simulation::Surface surface;
  simulation::Motion motion;
  std::vector<std::string> warnings;
  std::vector<Eigen::Vector3f> posed_vertices;
  std::vector<Eigen::Vector3f> posed_normals;
  std::optional<simulation::RayScene> scene;
  std::unique_ptr<simulation::Renderer> renderer;
  int posed_frame_idx = -1;  // -1: at rest
};

namespace {

// Scenes and cameras that no memory holds are refused before it is asked for.
Status CheckMemory(const SimulationOptions& options, double length_mm) {
  constexpr double kMaxTexels = 4e8;
  const bool sheet = options.scene.kind == SceneKind::kSurface || options.scene.kind == SceneKind::kLobes;
  const double around_mm = sheet ? 1.2 * options.scene.width_mm : 2 * 3.1416 * options.scene.radius_mm * 1.5;
  const double texels = around_mm * length_mm /
                        std::min(options.texture.texel_mm * options.texture.texel_mm,
                                 options.scene.mesh_step_mm * options.scene.mesh_step_mm / 8);
  const bool has_picture = options.scene.kind == SceneKind::kMesh || options.scene.kind == SceneKind::kBoard;
  if (!has_picture && texels > kMaxTexels)
    return {ErrorCode::kInvalidArgument,
            "a wall " + FormatDouble(std::round(length_mm)) +
                " mm long does not fit into memory at this resolution; shorten the path, or raise Texture.texel_mm and "
                "Scene.mesh_step_mm"};
  constexpr double kMaxRays = 4e8;
  const double rays = static_cast<double>(options.camera.width) * options.camera.height * (options.sensor.samples + 1);
  if (rays > kMaxRays)
    return {ErrorCode::kInvalidArgument, "the rays of " + std::to_string(options.camera.width) + "x" +
                                             std::to_string(options.camera.height) +
                                             " pixels do not fit into memory with Sensor.samples " +
                                             std::to_string(options.sensor.samples) + "; lower one of them"};
  return Status::Ok();
}

// What lasts longer than a frame.
Status CheckExposure(const SimulationOptions& options) {
  const SimulationOptions::Sensor& sensor = options.sensor;
  for (const auto& [name, time_s] :
       {std::pair{"shutter_s", sensor.shutter_s}, std::pair{"readout_s", sensor.readout_s}})
    if (time_s * options.trajectory.fps > 1.0)
      return {ErrorCode::kInvalidArgument, std::string("Sensor.") + name + " is " + FormatDouble(time_s) +
                                               ", longer than a frame at " + FormatDouble(options.trajectory.fps) +
                                               " frames a second; shorten it"};
  return Status::Ok();
}

// Files are named so that the options beside a sequence find them from any folder.
void MakeAbsolute(std::string* path) {
  std::error_code error;
  const auto absolute = std::filesystem::absolute(*path, error);
  if (!path->empty() && !error) *path = absolute.lexically_normal().string();
}

}  // namespace

Status Simulator::State::MakeSurface(double length_mm) {
  switch (options.scene.kind) {
    case SceneKind::kColon:
    case SceneKind::kTube: {
      const simulation::Centerline centerline(length_mm, options.scene.bend_deg_per_cm, options.scene.seed);
      surface = simulation::MakeTube(options.scene, centerline, length_mm);
      path.Follow(centerline);
      break;
    }
    case SceneKind::kSurface:
    case SceneKind::kLobes:
      surface = simulation::MakeSheet(options.scene, options.trajectory.height_mm, length_mm);
      break;
    case SceneKind::kMesh:
    case SceneKind::kBoard: {
      Result<simulation::Surface> made = options.scene.kind == SceneKind::kMesh
                                             ? simulation::MakeMeshSurface(options.scene)
                                             : simulation::MakeBoardSurface(options.scene);
      if (!made.ok()) return made.status();
      surface = *std::move(made);
      break;
    }
  }
  return Status::Ok();
}

std::vector<Eigen::Vector3d> Simulator::State::FirstView() const {
  constexpr int kAcross = 12;
  constexpr int kDown = 9;
  std::vector<Eigen::Vector2d> pixels;
  for (int y = 0; y < kDown; ++y)
    for (int x = 0; x < kAcross; ++x)
      pixels.emplace_back((x + 0.5) * camera.width() / kAcross - 0.5, (y + 0.5) * camera.height() / kDown - 0.5);
  const Eigen::Quaterniond world_from_cam = WorldFromCamera(0).rotation;
  std::vector<Eigen::Vector3d> rays;
  for (const auto& ray : camera.Unproject(pixels))
    if (ray) rays.emplace_back(world_from_cam * *ray);
  return rays;
}

// A file's triangles may run either way round; the side that the first camera sees is the inner one.
void Simulator::State::TurnNormalsToFirstView() {
  const std::vector<Eigen::Vector3d> rays = FirstView();
  std::vector<RayHit> hits(rays.size());
  scene->Intersect(WorldFromCamera(0).translation, rays, hits);
  int away = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (!hits[i].hit()) continue;
    const auto& t = surface.triangles[hits[i].point.triangle_idx];
    const Eigen::Vector3f normal = surface.normals[t[0]] + surface.normals[t[1]] + surface.normals[t[2]];
    away += normal.cast<double>().dot(rays[i]) > 0 ? 1 : -1;
  }
  if (away <= 0) return;
  for (Eigen::Vector3f& normal : surface.normals) normal = -normal;
}

// The position is given, or in the lower middle of the first image; the push goes against the wall's face there.
Result<simulation::Poke> Simulator::State::FindPoke() const {
  simulation::Poke poke;
  if (options.deformation.poke_mm == 0) return poke;
  const Rigid3 world_from_cam = WorldFromCamera(0);
  Eigen::Vector2d pixel(0.5 * (camera.width() - 1), 0.8 * (camera.height() - 1));
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  if (!options.deformation.poke_place.empty()) {
    const auto position = ParseNumbers(options.deformation.poke_place);
    if (!position || position->size() != 3)
      return {ErrorCode::kInvalidArgument,
              "Deformation.poke_place is '" + options.deformation.poke_place + "'; give x,y,z in mm"};
    direction = (Eigen::Vector3d(position->data()) - world_from_cam.translation).normalized();
  } else if (const auto ray = camera.Unproject(std::span(&pixel, 1))[0]) {
    direction = world_from_cam.rotation * *ray;
  }
  RayHit hit;
  scene->Intersect(world_from_cam.translation, std::span(&direction, 1), std::span(&hit, 1));
  if (!hit.hit())
    return {ErrorCode::kInvalidArgument,
            "the first camera sees no wall at the position of the poke; set Deformation.poke_place to a position in "
            "its view"};
  const auto& t = surface.triangles[hit.point.triangle_idx];
  poke.position = surface.AtRest(hit.point).position;
  poke.direction = (surface.normals[t[0]] + surface.normals[t[1]] + surface.normals[t[2]]).cast<double>().normalized();
  return poke;
}

void Simulator::State::CollectWarnings() {
  constexpr std::size_t kPoints = 5000;
  constexpr int kTimes = 40;
  std::vector<simulation::RestPoint> points;
  const std::size_t stride = surface.vertices.size() / kPoints + 1;
  for (std::size_t i = 0; i < surface.vertices.size(); i += stride)
    points.push_back(surface.VertexAtRest(static_cast<std::uint32_t>(i)));
  std::vector<double> times_s;
  for (int i = 0; i < options.trajectory.frames; i += options.trajectory.frames / kTimes + 1)
    times_s.push_back(i / options.trajectory.fps);
  warnings = simulation::DeformationWarnings(options, motion, points, times_s);
}

Status Simulator::State::Build(double length_mm) {
  if (Status status = MakeSurface(length_mm); !status.ok()) return status;
  const bool moves = !simulation::Motion(options.deformation, 1.0, {}).rigid();
  using Vertices = simulation::RayScene::Vertices;
  auto made = simulation::RayScene::Create(surface, moves ? Vertices::kMoving : Vertices::kFixed);
  if (!made.ok()) return made.status();
  scene = *std::move(made);
  if (options.scene.kind == SceneKind::kMesh) TurnNormalsToFirstView();
  posed_vertices = surface.vertices;
  posed_normals = surface.normals;
  const Result<simulation::Poke> poke = FindPoke();
  if (!poke.ok()) return poke.status();
  motion = simulation::Motion(options.deformation, surface.swell_radius_mm, *poke);
  CollectWarnings();
  return simulation::CheckClearance(options, path, length_mm, surface, motion, *scene, FirstView());
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
  assert(frame_idx >= 0 && frame_idx < std::ssize(recorded));
  if (motion.rigid() || posed_frame_idx == frame_idx) return;
  const double time_s = Time(frame_idx);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, surface.vertices.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const simulation::RestPoint at_rest = surface.VertexAtRest(static_cast<std::uint32_t>(i));
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
  if (Status status = CheckExposure(options); !status.ok()) return status;

  MakeAbsolute(&checked.scene.mesh_path);
  MakeAbsolute(&checked.trajectory.path);
  Result<simulation::Path> path = simulation::Path::Create(checked);
  if (!path.ok()) return path.status();

  const double needed_mm = path->ReachMm() + options.scene.view_mm;
  const double length_mm = options.scene.length_mm > 0 ? options.scene.length_mm : needed_mm;
  if (Status status = CheckMemory(options, length_mm); !status.ok()) return status;

  auto state = std::make_unique<State>(std::move(checked), *std::move(camera), *std::move(path));
  if (Status status = state->arena.execute([&] { return state->Build(length_mm); }); !status.ok()) return status;
  return Simulator(std::move(state));
}

const std::vector<std::string>& Simulator::warnings() const { return state_->warnings; }
const SimulationOptions& Simulator::options() const { return state_->options; }
const Camera& Simulator::camera() const { return state_->camera; }
int Simulator::frame_count() const { return static_cast<int>(state_->recorded.size()); }
double Simulator::TimeOf(int frame_idx) const {
  return state_->recorded[frame_idx].clock_idx / options().trajectory.fps;
}
double Simulator::ShownTimeOf(int frame_idx) const { return state_->Time(frame_idx); }
Rigid3 Simulator::WorldFromCamera(int frame_idx, Eye eye) const {
  const Rigid3 world_from_left = state_->WorldFromCamera(frame_idx);
  return eye == Eye::kLeft ? world_from_left : simulation::RightCamera(world_from_left, options().camera.baseline_mm);
}

Eigen::Vector3d Simulator::RestPosition(const MaterialPoint& point) const {
  return state_->surface.AtRest(point).position;
}

Eigen::Vector3d Simulator::Position(const MaterialPoint& point, int frame_idx) const {
  return state_->Position(point, ShownTimeOf(frame_idx));
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
    frame = renderer.Render(state_->recorded[frame_idx].shown_idx, *state_->scene, state_->posed_normals);
  });
  return frame;
}

}  // namespace pliant
