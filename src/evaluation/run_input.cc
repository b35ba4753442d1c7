// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/run_input.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <utility>

#include "pliant/base/text.h"
#include "pliant/colmap/convert.h"
#include "pliant/datasets/match_poses.h"
#include "pliant/io/run_reader.h"

namespace pliant {
namespace {

// Our runs write the sequence's times; only the digits written may differ.
constexpr double kTimeToleranceS = 1e-3;
// The tracker's name for what its initializer takes.
constexpr std::string_view kInitializeStage = "initialize";

using FrameMap = std::map<int, EvaluationFrame>;  // by frame number

EvaluationFrame& FrameAt(int frame_idx, double timestamp_s, FrameMap* frames) {
  EvaluationFrame& frame = (*frames)[frame_idx];
  frame.frame_idx = frame_idx;
  frame.timestamp_s = timestamp_s;
  return frame;
}

void TakeRow(const Run& run, const RunFrame& row, EvaluationFrame* frame) {
  frame->submap = row.submap;
  for (std::size_t i = 0; i < run.stage_names.size(); ++i)
    if (run.stage_names[i] == kInitializeStage) frame->initialize_ms = row.stage_ms[i];
  if (!run.summary || run.summary->first_maps.empty()) return;
  frame->makes_map_alone = std::ranges::any_of(run.summary->first_maps, [&](const FirstMapFrames& map) {
    return map.reference_frame_idx == row.frame_idx && map.declared_frame_idx == row.frame_idx;
  });
  const FirstMapFrames& first_map = run.summary->first_maps.front();
  if (first_map.reference_frame_idx <= row.frame_idx && row.frame_idx <= first_map.declared_frame_idx)
    frame->first_map = first_map;
}

// The poses of another system's result.
Status GivePosesFrames(const std::string& name, const std::vector<RunPose>& poses, const Sequence& sequence,
                       double max_difference_s, EvaluationInput* input, FrameMap* frames) {
  std::vector<TimedPose> timed;
  for (const RunPose& pose : poses) timed.push_back({pose.timestamp_s, pose.world_from_cam});
  const auto matched = MatchPoses(timed, sequence, max_difference_s, name);
  if (!matched.ok()) return matched.status();
  for (const auto& [frame_idx, world_from_cam] : matched->world_from_cam)
    FrameAt(frame_idx, *sequence.TimestampS(frame_idx), frames).cam_from_world = world_from_cam.Inverse();
  input->notes.insert(input->notes.end(), matched->notes.begin(), matched->notes.end());
  return Status::Ok();
}

// Of another system's result: `unmatched` frames of the sequence have points, but by its time no pose. Where there are
// as many poses as frames with points, each of these frames should have one.
Status CheckPosesOfPoints(const std::string& run_path, std::size_t poses, std::size_t with_points,
                          std::size_t unmatched) {
  constexpr std::size_t kMinCompared = 5;  // fewer are as many by chance
  if (poses != with_points || poses < kMinCompared || 3 * unmatched < poses) return Status::Ok();
  return {ErrorCode::kMismatch, run_path + " has " + std::to_string(poses) +
                                    " poses and as many frames with points, but by the times of the poses " +
                                    std::to_string(unmatched) +
                                    " of these frames have none: give each pose the time of its frame"};
}

// Adds the points to the frames. Of another system's result, of so many poses, frames may have points and no pose.
// `sequence` is null where the run is Pliant's own.
Status ReadPoints(const std::string& run_path, const Sequence* sequence, std::size_t poses, EvaluationInput* input,
                  FrameMap* frames) {
  Result<ObservationReader> reader = ObservationReader::Open(run_path);
  if (!reader.ok()) return reader.status();
  std::size_t with_points = 0;
  std::size_t without_pose = 0;
  std::size_t unmatched = 0;
  while (true) {
    Result<std::optional<FrameObservations>> rows = reader->Next();
    if (!rows.ok()) return rows.status();
    if (!rows->has_value()) break;
    ++with_points;
    const int frame_idx = (*rows)->frame_idx;
    const auto frame = frames->find(frame_idx);
    if (frame != frames->end() && frame->second.cam_from_world) {
      frame->second.observations = std::move((*rows)->observations);
    } else if (sequence != nullptr) {
      const auto time_s = sequence->TimestampS(frame_idx);
      ++without_pose;
      if (time_s) ++unmatched;
      FrameAt(frame_idx, time_s.value_or(0), frames);
    }  // else: a killed run may have written the points of a frame whose pose it had not
  }
  if (Status status = CheckPosesOfPoints(run_path, poses, with_points, unmatched); !status.ok()) return status;
  if (without_pose > 0)
    input->notes.push_back(std::to_string(without_pose) + " frames of " + run_path +
                           " have points and no pose; they count as not tracked");
  return Status::Ok();
}

Result<std::optional<Camera>> ReadRunCamera(const std::string& run_path) {
  for (const char* name : {"cameras.txt", "cameras.bin", "0/cameras.txt", "0/cameras.bin"}) {
    const std::filesystem::path path = std::filesystem::path(run_path) / "sparse" / name;
    std::error_code error;
    if (!std::filesystem::exists(path, error)) continue;
    auto camera = colmap::ReadCamera(path.string());
    if (!camera.ok()) return camera.status();
    return std::optional<Camera>(std::move(camera).value());
  }
  return std::optional<Camera>();
}

// `sequence` may be null.
Result<EvaluationInput> ReadInput(const std::string& run_path, const Sequence* sequence,
                                  const MatchingOptions& options) {
  const Result<Run> run = ReadRun(run_path);
  if (!run.ok()) return run.status();
  EvaluationInput input;
  input.name = run_path;
  Result<std::optional<Camera>> camera = ReadRunCamera(run_path);
  if (!camera.ok()) return camera.status();
  input.camera = *std::move(camera);
  if (run->summary && run->summary->total_s > 0) input.seconds = run->summary->total_s;
  if (run->summary) input.metric = run->summary->description.metric.value_or(false);

  FrameMap frames;
  for (const RunFrame& row : run->frames) TakeRow(*run, row, &FrameAt(row.frame_idx, row.timestamp_s, &frames));
  const bool foreign = run->frames.empty() && !run->summary;
  if (foreign && sequence == nullptr)
    return Status(ErrorCode::kNotFound, "the run " + run_path +
                                            " is another system's, whose poses belong to frames by their times; give "
                                            "--sequence");
  if (foreign) {
    if (Status status =
            GivePosesFrames(run_path, run->poses, *sequence, options.max_time_difference_s, &input, &frames);
        !status.ok())
      return status;
  } else {
    for (const RunPose& pose : run->poses) {
      if (!pose.frame_idx)
        return Status(ErrorCode::kMismatch,
                      "the run " + run_path + " has poses whose frames are not known; is its frames.csv missing?");
      FrameAt(*pose.frame_idx, pose.timestamp_s, &frames).cam_from_world = pose.world_from_cam.Inverse();
    }
  }
  if (Status status = ReadPoints(run_path, foreign ? sequence : nullptr, run->poses.size(), &input, &frames);
      !status.ok())
    return status;
  for (auto& entry : frames) input.frames.push_back(std::move(entry.second));
  return input;
}

// The largest distance between where two cameras of one image size see the same rays, px, on a grid over the image.
double LargestDifferencePx(const Camera& a, const Camera& b) {
  constexpr int kSteps = 8;
  double largest = 0;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const Eigen::Vector2d pixel((a.width() - 1) * i / double{kSteps}, (a.height() - 1) * j / double{kSteps});
      const auto ray = a.Unproject(pixel);
      const auto seen = ray ? b.Project(*ray) : std::nullopt;
      if (seen) largest = std::max(largest, (*seen - pixel).norm());
    }
  }
  return largest;
}

Status CheckCamera(const EvaluationInput& run, const Camera& camera, CameraAgreement agreement) {
  constexpr double kSame_px = 0.01;
  if (!run.camera) return Status::Ok();
  const auto size = [](const Camera& c) { return std::to_string(c.width()) + "x" + std::to_string(c.height()); };
  if (size(*run.camera) != size(camera))
    return {ErrorCode::kMismatch, "the run " + run.name + " was made on images of " + size(*run.camera) +
                                      " and the sequence has " + size(camera) + "; give the sequence that was tracked"};
  const double difference_px = LargestDifferencePx(*run.camera, camera);
  if (agreement == CameraAgreement::kSame && difference_px > kSame_px)
    return {ErrorCode::kMismatch, "the camera of the run " + run.name + " sees points up to " +
                                      FormatDouble(std::round(100 * difference_px) / 100) +
                                      " px from where the sequence's camera sees them; give the sequence that was "
                                      "tracked, or --Evaluation.camera any"};
  return Status::Ok();
}

}  // namespace

void MatchingOptions::List(OptionTable& table) {
  table.Add("max_time_difference_s", &max_time_difference_s, "s",
            "another system's poses belong to the nearest frame in time, if it is not further than this", 0.0, 10.0);
  table.AddChoice("camera", &camera, "whether the camera in the run's sparse/ must be the sequence's");
}

EvaluationFrame FrameFromReport(const FrameReport& report) {
  EvaluationFrame frame{report.frame_idx, report.timestamp_s, report.cam_from_world, report.observations,
                        report.first_map};
  for (const auto& [stage, ms] : report.stage_ms)
    if (stage == kInitializeStage) frame.initialize_ms = ms;
  frame.makes_map_alone =
      report.first_map && report.first_map->reference_frame_idx == report.first_map->declared_frame_idx;
  frame.submap = report.submap;
  return frame;
}

Result<EvaluationInput> ReadEvaluationInput(const std::string& run_path, const Sequence& sequence,
                                            const MatchingOptions& options) {
  return ReadInput(run_path, &sequence, options);
}

Result<EvaluationInput> ReadEvaluationInput(const std::string& run_path) { return ReadInput(run_path, nullptr, {}); }

Status CheckBelongsTo(const EvaluationInput& run, const Sequence& sequence, const MatchingOptions& options) {
  const std::string advice = "; give the sequence that was tracked";
  for (const EvaluationFrame& frame : run.frames) {
    const std::optional<double> time_s = sequence.TimestampS(frame.frame_idx);
    if (!time_s && sequence.TimestampS(0))
      return {ErrorCode::kMismatch, "the run " + run.name + " has a frame " + std::to_string(frame.frame_idx) +
                                        ", which the sequence does not have" + advice};
    if (time_s && !(std::abs(*time_s - frame.timestamp_s) <= kTimeToleranceS))
      return {ErrorCode::kMismatch, "frame " + std::to_string(frame.frame_idx) + " is at " +
                                        Seconds(frame.timestamp_s) + " in the run " + run.name + " and at " +
                                        Seconds(*time_s) + " in the sequence" + advice};
  }
  return CheckCamera(run, sequence.camera(), options.camera);
}

}  // namespace pliant
