// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/add_truth.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "pliant/evaluation/surface_truth.h"
#include "pliant/surface/placed_mesh.h"

namespace pliant {
namespace {

constexpr double kRasterColumns = 192;  // across an image, to find the hidden vertices of a mesh

using FrameValues = std::map<int, double>;  // by frame

void AddError(std::string name, const FrameValues& values, ViewedRun* run) {
  std::vector<std::optional<double>> column;
  for (const ViewedFrame& frame : run->frames) {
    const auto value = values.find(frame.row.frame_idx);
    column.push_back(value != values.end() ? std::optional(value->second) : std::nullopt);
  }
  run->errors.emplace_back(std::move(name), std::move(column));
}

void AddErrors(const Evaluation& evaluation, ViewedRun* run) {
  const auto of_points = [](const PointError& error, double PointFigures::*figure, bool null) {
    FrameValues values;
    for (const PointFrameError& frame : error.plain.frames)
      values.emplace(frame.frame_idx, (null ? frame.null : frame.estimate).*figure);
    return values;
  };
  if (evaluation.surface) {
    AddError("surface RMSE, mm", of_points(*evaluation.surface, &PointFigures::rmse_mm, false), run);
    AddError("surface median, mm", of_points(*evaluation.surface, &PointFigures::median_mm, false), run);
    AddError("one constant depth, RMSE, mm", of_points(*evaluation.surface, &PointFigures::rmse_mm, true), run);
  }
  if (evaluation.material)
    AddError("material RMSE, mm", of_points(evaluation.material->error, &PointFigures::rmse_mm, false), run);
  if (evaluation.trajectory) {
    FrameValues values;
    for (std::size_t i = 0; i < evaluation.trajectory->frame_idx.size(); ++i)
      values.emplace(evaluation.trajectory->frame_idx[i], evaluation.trajectory->ate_mm[i]);
    AddError("camera (ATE), mm", values, run);
  }
}

// The true surface on each pixel's ray, camera frame, mm; nothing where it is not known, or not well enough.
Result<std::vector<std::optional<Eigen::Vector3d>>> TrueSurfaceAt(const Camera& camera, int frame_idx,
                                                                  std::span<const Eigen::Vector2d> pixels,
                                                                  SurfaceTruth* surface) {
  std::vector<std::optional<Eigen::Vector3d>> truth(pixels.size());
  const auto depths = surface->At(frame_idx, pixels);
  if (!depths.ok()) return depths.status();
  if (!depths->has_value()) return truth;
  const auto rays = camera.Unproject(pixels);
  const double max_sigma_mm = EvaluationOptions().points.max_truth_sigma_mm;
  for (std::size_t k = 0; k < pixels.size(); ++k) {
    const DepthAtPixel& depth = (**depths)[k];
    if (depth.lookup == DepthLookup::kOk && depth.sigma_mm <= max_sigma_mm && rays[k] && rays[k]->z() > 0)
      truth[k] = depth.depth_mm / rays[k]->z() * *rays[k];
  }
  return truth;
}

// Where the true surface is at each point's pixel, seen from the run's camera, in the run's unit.
Status AddSurface(const Camera& camera, SurfaceTruth* surface, ViewedRun* run) {
  for (std::size_t i = 0; i < run->frames.size(); ++i) {
    ViewedFrame& frame = run->frames[i];
    if (!frame.world_from_cam || !run->scales[i]) continue;
    const double scale = *run->scales[i];
    std::vector<Eigen::Vector2d> pixels;
    for (const ViewedObservation& o : frame.observations) pixels.push_back(o.pixel.cast<double>());
    const auto truth_in_cam = TrueSurfaceAt(camera, frame.row.frame_idx, pixels, surface);
    if (!truth_in_cam.ok()) return truth_in_cam.status();
    const Rigid3 cam_from_world = frame.world_from_cam->Inverse();
    for (std::size_t k = 0; k < pixels.size(); ++k) {
      const auto& truth = (*truth_in_cam)[k];
      if (!truth) continue;
      ViewedObservation& o = frame.observations[k];
      o.truth = (*frame.world_from_cam * (*truth / scale)).cast<float>();
      o.error_mm = static_cast<float>((scale * (cam_from_world * o.position.cast<double>()) - *truth).norm());
    }
  }
  return Status::Ok();
}

// The vertices that a camera sees.
std::vector<std::size_t> SeenVertices(const Camera& camera, const Mesh& mesh, const PlacedMesh& placed) {
  std::vector<std::size_t> seen;
  for (std::size_t v = 0; v < placed.in_cam.size(); ++v)
    if (placed.IsInImage(camera, v) &&
        !placed.IsHidden(mesh.triangles, v, DepthTolerance(placed.in_cam[v], mesh.sigmas[v], 0.0)))
      seen.push_back(v);
  return seen;
}

// How far the vertices that a frame shows are from the true surface.
Status AddVertexErrors(const Camera& camera, const ViewedFrame& frame, double scale, SurfaceTruth* surface,
                       ViewedMesh* mesh) {
  const auto& keys = mesh->surface.keys;
  const auto key = std::ranges::find(keys, frame.row.frame_idx, &MeshKey::frame_idx);
  if (mesh->surface.submap != frame.row.submap || key == keys.end()) return Status::Ok();
  const Rigid3 cam_from_world = frame.world_from_cam->Inverse();
  std::vector<Eigen::Vector3d> in_cam;
  for (const Eigen::Vector3f& position : key->positions) in_cam.push_back(cam_from_world * position.cast<double>());
  const PlacedMesh placed = PlaceMesh(camera, std::move(in_cam), mesh->surface.mesh.triangles, {},
                                      std::max(1.0, camera.width() / kRasterColumns));
  const std::vector<std::size_t> seen = SeenVertices(camera, mesh->surface.mesh, placed);
  std::vector<Eigen::Vector2d> pixels;
  for (const std::size_t v : seen) pixels.push_back(*placed.pixels[v]);
  const auto truth_in_cam = TrueSurfaceAt(camera, frame.row.frame_idx, pixels, surface);
  if (!truth_in_cam.ok()) return truth_in_cam.status();
  std::vector<float>& errors_mm = mesh->errors_mm[static_cast<std::size_t>(key - keys.begin())];
  for (std::size_t k = 0; k < seen.size(); ++k)
    if (const auto& truth = (*truth_in_cam)[k])
      errors_mm[seen[k]] = static_cast<float>((scale * placed.in_cam[seen[k]] - *truth).norm());
  return Status::Ok();
}

Status AddMeshErrors(const Camera& camera, SurfaceTruth* surface, ViewedRun* run) {
  for (ViewedMesh& mesh : run->meshes)
    mesh.errors_mm.assign(mesh.surface.keys.size(), std::vector<float>(mesh.surface.mesh.vertices.size(), kUnknown));
  for (std::size_t i = 0; i < run->frames.size(); ++i) {
    if (!run->frames[i].world_from_cam || !run->scales[i]) continue;
    for (ViewedMesh& mesh : run->meshes)
      if (Status status = AddVertexErrors(camera, run->frames[i], *run->scales[i], surface, &mesh); !status.ok())
        return status;
  }
  const auto is_known = [](const std::vector<float>& errors_mm) {
    return std::ranges::any_of(errors_mm, [](float error_mm) { return std::isfinite(error_mm); });
  };
  for (ViewedMesh& mesh : run->meshes)
    if (std::ranges::none_of(mesh.errors_mm, is_known)) mesh.errors_mm.clear();
  return Status::Ok();
}

}  // namespace

EvaluationInput FramesOf(const ViewedRun& run) {
  EvaluationInput frames;
  frames.name = run.name;
  frames.camera = run.camera;
  for (const ViewedFrame& frame : run.frames) {
    EvaluationFrame& of_frame = frames.frames.emplace_back();
    of_frame.frame_idx = frame.row.frame_idx;
    of_frame.timestamp_s = frame.row.timestamp_s;
  }
  return frames;
}

Result<Evaluation> AddTruth(const std::string& run_path, const OpenedTruth& truth, const JobProgress& progress,
                            ViewedRun* run) {
  const EvaluationOptions options;
  Result<Evaluation> evaluation = EvaluateRun(run_path, truth, options, progress);
  if (!evaluation.ok()) return evaluation.status();
  AddErrors(*evaluation, run);
  if (!evaluation->surface) return evaluation;
  FrameValues scales;
  for (const PointFrameError& frame : evaluation->surface->plain.frames)
    scales.emplace(frame.frame_idx, frame.estimate.scale);
  for (const ViewedFrame& frame : run->frames) {
    const auto scale = scales.find(frame.row.frame_idx);
    run->scales.push_back(scale != scales.end() && scale->second > 0 ? std::optional(scale->second) : std::nullopt);
  }
  // Those of the meshes have a truth of their own: what pairs tell of a pixel depends on the others.
  const auto add = [&](Status (*of_surface)(const Camera&, SurfaceTruth*, ViewedRun*)) -> Status {
    const auto surface = OpenSurfaceTruth(options.surface_from, FramesOf(*run), *truth.sequence, truth.request,
                                          options.points.max_depth_step);
    return surface.ok() ? of_surface(truth.sequence->camera(), surface->get(), run) : surface.status();
  };
  if (Status status = add(AddSurface); !status.ok()) return status;
  if (run->meshes.empty()) return evaluation;
  if (Status status = add(AddMeshErrors); !status.ok()) return status;
  return evaluation;
}

}  // namespace pliant
