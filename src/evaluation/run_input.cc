// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <map>
#include <utility>

#include "pliant/evaluation/evaluation.h"
#include "pliant/io/run_reader.h"

namespace pliant {

Result<EvaluationInput> ReadEvaluationInput(const std::string& run_path) {
  const Result<Run> run = ReadRun(run_path);
  if (!run.ok()) return run.status();
  Result<ObservationReader> reader = ObservationReader::Open(run_path);
  if (!reader.ok()) return reader.status();

  std::map<int, EvaluationFrame> frames;  // by frame number
  for (const RunFrame& row : run->frames) {
    EvaluationFrame& frame = frames[row.frame_idx];
    frame.frame_idx = row.frame_idx;
    frame.timestamp_s = row.timestamp_s;
  }
  for (const RunPose& pose : run->poses) {
    EvaluationFrame& frame = frames[pose.frame_idx];
    frame.frame_idx = pose.frame_idx;
    frame.timestamp_s = pose.timestamp_s;
    frame.cam_from_world = pose.world_from_cam.Inverse();
  }
  while (true) {
    Result<std::optional<FrameObservations>> rows = reader->Next();
    if (!rows.ok()) return rows.status();
    if (!rows->has_value()) break;
    const auto frame = frames.find((*rows)->frame_idx);
    // A killed run may have written the points of a frame whose pose it had not.
    if (frame != frames.end() && frame->second.cam_from_world)
      frame->second.observations = std::move((*rows)->observations);
  }
  EvaluationInput input;
  input.name = run_path;
  for (auto& entry : frames) input.frames.push_back(std::move(entry.second));
  return input;
}

}  // namespace pliant
