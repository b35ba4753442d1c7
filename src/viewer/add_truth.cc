// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/add_truth.h"

#include <map>
#include <utility>
#include <vector>

#include "pliant/evaluation/surface_truth.h"

namespace pliant {
namespace {

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

// Where the true surface is at each point's pixel, seen from the run's camera, in the run's unit.
Status AddSurface(const Camera& camera, double max_sigma_mm, SurfaceTruth* surface, ViewedRun* run) {
  for (std::size_t i = 0; i < run->frames.size(); ++i) {
    ViewedFrame& frame = run->frames[i];
    if (!frame.world_from_cam || !run->scales[i]) continue;
    const double scale = *run->scales[i];
    std::vector<Eigen::Vector2d> pixels;
    for (const ViewedObservation& o : frame.observations) pixels.push_back(o.pixel.cast<double>());
    const auto depths = surface->At(frame.row.frame_idx, pixels);
    if (!depths.ok()) return depths.status();
    if (!depths->has_value()) continue;
    const auto rays = camera.Unproject(pixels);
    const Rigid3 cam_from_world = frame.world_from_cam->Inverse();
    for (std::size_t k = 0; k < pixels.size(); ++k) {
      const DepthAtPixel& depth = (**depths)[k];
      if (depth.lookup != DepthLookup::kOk || depth.sigma_mm > max_sigma_mm || !rays[k] || !(rays[k]->z() > 0))
        continue;
      const Eigen::Vector3d truth_in_cam = depth.depth_mm / rays[k]->z() * *rays[k];
      ViewedObservation& o = frame.observations[k];
      o.truth = (*frame.world_from_cam * (truth_in_cam / scale)).cast<float>();
      o.error_mm = static_cast<float>((scale * (cam_from_world * o.position.cast<double>()) - truth_in_cam).norm());
    }
  }
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

Result<Evaluation> AddTruth(const std::string& run_path, const OpenedTruth& truth, ViewedRun* run) {
  const EvaluationOptions options;
  Result<Evaluation> evaluation = EvaluateRun(run_path, truth, options);
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
  const auto surface = OpenSurfaceTruth(options.surface_from, FramesOf(*run), *truth.sequence, truth.request,
                                        options.points.max_depth_step);
  if (!surface.ok()) return surface.status();
  if (Status status = AddSurface(truth.sequence->camera(), options.points.max_truth_sigma_mm, surface->get(), run);
      !status.ok())
    return status;
  return evaluation;
}

}  // namespace pliant
