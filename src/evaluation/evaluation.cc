// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/evaluation.h"

#include <cmath>
#include <utility>

namespace pliant {
namespace {

// Run and sequence write the same times; only the digits written may differ.
constexpr double kTimeToleranceS = 1e-3;

// The truth of the tracked frames, collected in one pass.
struct CollectedTruth {
  std::vector<SurfaceFrame> surface;
  std::vector<PosePair> poses;
  bool has_depth = false;
  bool has_pose = false;
};

Status CheckBelongsTo(const EvaluationInput& run, const Sequence& sequence) {
  for (const EvaluationFrame& frame : run.frames) {
    const std::optional<double> time_s = sequence.TimestampS(frame.frame_idx);
    if (!time_s && sequence.TimestampS(0))
      return {ErrorCode::kMismatch, "the run " + run.name + " has a frame " + std::to_string(frame.frame_idx) +
                                        ", which the sequence does not have; give the sequence that was tracked"};
    if (time_s && !(std::abs(*time_s - frame.timestamp_s) <= kTimeToleranceS))
      return {ErrorCode::kMismatch, "frame " + std::to_string(frame.frame_idx) + " is at " +
                                        std::to_string(frame.timestamp_s) + " s in the run " + run.name + " and at " +
                                        std::to_string(*time_s) +
                                        " s in the sequence; give the sequence that was tracked"};
  }
  return Status::Ok();
}

SurfaceFrame PairFrame(const EvaluationFrame& frame, const Camera& camera, const cv::Mat& depth_mm,
                       double max_depth_step) {
  std::vector<Eigen::Vector3d> points_in_cam;
  std::vector<Eigen::Vector2d> pixels;
  for (const PointObservation& observation : frame.observations) {
    points_in_cam.push_back(*frame.cam_from_world * observation.position);
    pixels.push_back(observation.pixel);
  }
  return PairWithSurface(frame.frame_idx, points_in_cam, pixels, camera, depth_mm, max_depth_step);
}

Result<CollectedTruth> CollectTruth(const EvaluationInput& run, const Sequence& sequence,
                                    const EvaluationOptions& options) {
  CollectedTruth truth;
  for (const EvaluationFrame& frame : run.frames) {
    if (!frame.cam_from_world) continue;
    const Result<std::optional<cv::Mat>> depth_mm = sequence.Depth(frame.frame_idx);
    if (!depth_mm.ok()) return depth_mm.status();
    if (depth_mm->has_value()) {
      truth.has_depth = true;
      truth.surface.push_back(PairFrame(frame, sequence.camera(), **depth_mm, options.surface.max_depth_step));
    }
    if (const std::optional<Rigid3> world_from_cam = sequence.WorldFromCamera(frame.frame_idx)) {
      truth.has_pose = true;
      truth.poses.push_back({frame.frame_idx, frame.cam_from_world->Inverse(), *world_from_cam});
    }
  }
  return truth;
}

TrackSurvival Survival(const EvaluationInput& run) {
  std::vector<FrameTracks> tracks;
  for (const EvaluationFrame& frame : run.frames) {
    FrameTracks& row = tracks.emplace_back();
    row.frame_idx = frame.frame_idx;
    row.tracked = frame.cam_from_world.has_value();
    if (!row.tracked) continue;
    for (const PointObservation& observation : frame.observations) row.ids.push_back(observation.id);
  }
  return ComputeTrackSurvival(tracks);
}

}  // namespace

EvaluationFrame FrameFromReport(const FrameReport& report) {
  return {report.frame_idx, report.timestamp_s, report.cam_from_world, report.observations};
}

void EvaluationOptions::List(OptionTable& table) {
  table.BeginGroup("SurfaceError", "distance of the estimated points from the true surface");
  surface.List(table);
  table.BeginGroup("TrajectoryError", "distance of the estimated camera path from the true one");
  trajectory.List(table);
}

Result<Evaluation> Evaluate(const EvaluationInput& run, const Sequence& sequence, const EvaluationOptions& options) {
  if (Status status = CheckBelongsTo(run, sequence); !status.ok()) return status;
  Evaluation evaluation;
  evaluation.run = run.name;
  evaluation.survival = Survival(run);
  if (evaluation.survival.frames_tracked == 0)
    return Status(ErrorCode::kInsufficient, "the run " + run.name + " has no tracked frame among the " +
                                                std::to_string(run.frames.size()) +
                                                " it read; there is nothing to evaluate");
  const Result<CollectedTruth> truth = CollectTruth(run, sequence, options);
  if (!truth.ok()) return truth.status();
  if (!truth->has_depth && !truth->has_pose)
    return Status(ErrorCode::kNotFound, "the sequence of the run " + run.name +
                                            " has no truth for the tracked frames: neither depth/ nor groundtruth.txt; "
                                            "evaluate on a sequence that has one of them");
  if (truth->has_depth) {
    Result<SurfaceError> surface = ComputeSurfaceError(truth->surface, options.surface);
    if (surface.ok())
      evaluation.surface = *std::move(surface);
    else
      evaluation.notes.push_back("no surface error: " + surface.status().message());
  } else {
    evaluation.notes.push_back("no surface error: the sequence has no depth for the tracked frames");
  }
  if (truth->has_pose) {
    Result<TrajectoryError> trajectory = ComputeTrajectoryError(truth->poses, options.trajectory);
    if (trajectory.ok())
      evaluation.trajectory = *std::move(trajectory);
    else
      evaluation.notes.push_back("no camera error: " + trajectory.status().message());
  } else {
    evaluation.notes.push_back("no camera error: the sequence has no pose for the tracked frames");
  }
  return evaluation;
}

}  // namespace pliant
