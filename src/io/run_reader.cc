// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/run_reader.h"

#include <algorithm>
#include <filesystem>

#include "io/run_format.h"
#include "io/tum_line.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

// Empty: the row is right; else what is wrong with it.
std::string ParseFrame(std::string_view line, std::size_t num_columns, std::size_t num_stages, RunFrame* frame) {
  const std::vector<std::string_view> fields = Split(line, ',');
  if (fields.size() != num_columns + num_stages)
    return "a row has " + std::to_string(num_columns + num_stages) + " columns, this one has " +
           std::to_string(fields.size());
  const auto state = std::find_if(EnumNames<TrackingState>::kNames.begin(), EnumNames<TrackingState>::kNames.end(),
                                  [&](const auto& entry) { return entry.second == fields[2]; });
  if (state == EnumNames<TrackingState>::kNames.end()) return Quoted(fields[2]) + " is not a state";
  frame->state = state->first;
  std::vector<std::pair<std::size_t, int*>> counts = {
      {0, &frame->frame_idx}, {3, &frame->tracked}, {4, &frame->optimized}, {5, &frame->lost}, {6, &frame->added}};
  if (num_columns == kNumFrameColumns) counts.emplace_back(num_columns - 1, &frame->submap);
  for (const auto& [column, value] : counts)
    if (!ParseInt(fields[column], value) || *value < 0) return Quoted(fields[column]) + " is not a whole number";
  frame->stage_ms.resize(num_stages);
  std::vector<std::pair<std::size_t, double*>> numbers = {
      {1, &frame->timestamp_s},    {7, &frame->costs.reprojection}, {8, &frame->costs.spatial},
      {9, &frame->costs.temporal}, {10, &frame->costs.edge_length}, {11, &frame->median_reprojection_error_px}};
  for (std::size_t i = 0; i < num_stages; ++i) numbers.emplace_back(num_columns + i, &frame->stage_ms[i]);
  for (const auto& [column, value] : numbers)
    if (!ParseFinite(fields[column], value)) return Quoted(fields[column]) + " is not a finite number";
  return {};
}

Status ReadFrames(const std::string& path, Run* run) {
  auto lines = LineReader::Open(path);
  if (!lines.ok()) return lines.status();
  std::string_view line;
  if (!lines->Next(&line) || !lines->ended()) return Status::Ok();  // killed before the first row
  const std::vector<std::string_view> columns = Split(line, ',');
  // Runs of before there were submaps.
  const std::size_t num_columns = kNumFrameColumns - (line.starts_with(kFrameColumns) ? 0 : 1);
  const bool known = line.starts_with(kFrameColumns.substr(0, kFrameColumns.size() - kSubmapColumn.size())) &&
                     std::all_of(columns.begin() + static_cast<std::ptrdiff_t>(num_columns), columns.end(),
                                 [](std::string_view column) { return column.starts_with(kStagePrefix); });
  if (!known)
    return lines->Error("the first line must begin with " + Quoted(kFrameColumns) + ", then stages " +
                        Quoted(kStagePrefix) + "...");
  for (std::size_t i = num_columns; i < columns.size(); ++i)
    run->stage_names.emplace_back(columns[i].substr(kStagePrefix.size()));
  while (lines->Next(&line)) {
    if (!lines->ended()) {
      ++run->cut_lines;
      break;
    }
    RunFrame frame;
    if (const std::string wrong = ParseFrame(line, num_columns, run->stage_names.size(), &frame); !wrong.empty())
      return lines->Error(wrong);
    if (!run->frames.empty() && frame.frame_idx <= run->frames.back().frame_idx)
      return lines->Error("frame " + std::to_string(frame.frame_idx) + " is not after the row before");
    run->frames.push_back(std::move(frame));
  }
  return Status::Ok();
}

// Gives the poses the frames of frames.csv that were tracked.
Status NumberPoses(const std::string& path, Run* run) {
  std::vector<const RunFrame*> tracked;
  for (const RunFrame& frame : run->frames)
    if (frame.state == TrackingState::kTracking) tracked.push_back(&frame);
  // A frame's row in frames.csv is written last: a killed run may have a pose or two more than rows.
  const bool belong = run->summary ? run->poses.size() >= tracked.size() : run->poses.size() == tracked.size();
  if (!belong)
    return {ErrorCode::kMismatch, "the folder " + Quoted(path) + " has " + std::to_string(run->poses.size()) +
                                      " poses in trajectory.txt for " + std::to_string(tracked.size()) +
                                      " tracked frames in frames.csv; each tracked frame needs one"};
  run->poses.resize(tracked.size());
  for (std::size_t i = 0; i < tracked.size(); ++i) {
    run->poses[i].frame_idx = tracked[i]->frame_idx;
    run->poses[i].submap = tracked[i]->submap;
  }
  return Status::Ok();
}

}  // namespace

Result<Run> ReadRun(const std::string& path) {
  const auto exists = [&](const char* name) {
    std::error_code error;
    return std::filesystem::exists(path + name, error);
  };
  std::error_code error;
  if (!std::filesystem::is_directory(path, error))
    return Status(ErrorCode::kNotFound, "there is no run folder " + Quoted(path) + "; check the path");
  for (const char* name : {"/trajectory.txt", "/observations.csv"})
    if (!exists(name))
      return Status(ErrorCode::kNotFound, "the folder " + Quoted(path) + " holds no " + (name + 1) +
                                              "; a run has trajectory.txt and observations.csv");
  Run run;
  const bool ours = exists("/run.json");
  if (ours) {
    auto summary = ReadRunSummary(path + "/run.json");
    if (!summary.ok()) return summary.status();
    run.summary = std::move(summary).value();
  }
  const bool has_frames = exists("/frames.csv");
  if (has_frames)
    if (const Status status = ReadFrames(path + "/frames.csv", &run); !status.ok()) return status;

  // Ours end every line, so an open one was cut; another program may leave its last line open.
  const auto poses =
      ReadTumTrajectory(path + "/trajectory.txt", ours ? OpenLastLine::kIsCut : OpenLastLine::kIsRead, &run.cut_lines);
  if (!poses.ok()) return poses.status();
  for (const TimedPose& pose : *poses) run.poses.push_back({std::nullopt, pose.timestamp_s, pose.world_from_cam});
  if (has_frames)
    if (Status status = NumberPoses(path, &run); !status.ok()) return status;
  return run;
}

}  // namespace pliant
