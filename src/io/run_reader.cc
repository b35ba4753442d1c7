// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/run_reader.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>

#include <zlib.h>

#include "io/run_format.h"
#include "io/tum_line.h"
#include "pliant/base/files.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

// Where the columns of frames.csv are; others than these are of no interest.
struct FrameColumns {
  struct Count {
    std::size_t column;
    int RunFrame::*value;
  };
  struct Number {
    std::size_t column;
    double RunFrame::*value;
  };
  struct Named {
    std::size_t column;
    std::string name;
  };

  std::size_t size = 0;
  std::size_t state = 0;
  std::vector<Count> counts;
  std::vector<Number> numbers;
  std::vector<Named> costs;
  std::vector<Named> stages;
};

// The first column that is missing, or empty.
std::string FindColumns(std::string_view line, FrameColumns* columns) {
  const std::vector<std::string_view> names = Split(line, ',');
  columns->size = names.size();
  std::string missing;
  const auto find = [&](std::string_view name) {
    const auto it = std::find(names.begin(), names.end(), name);
    if (it == names.end() && missing.empty()) missing = name;
    return static_cast<std::size_t>(it - names.begin());
  };
  columns->state = find("state");
  columns->counts = {{find("frame"), &RunFrame::frame_idx},
                     {find("tracked"), &RunFrame::tracked},
                     {find("optimized"), &RunFrame::optimized},
                     {find("lost"), &RunFrame::lost},
                     {find("added"), &RunFrame::added}};
  columns->numbers = {{find("timestamp"), &RunFrame::timestamp_s},
                      {find("median_reprojection_error_px"), &RunFrame::median_reprojection_error_px}};
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == kLatencyColumn) columns->numbers.push_back({i, &RunFrame::latency_ms});
    // Runs of before there were submaps have no such column: theirs is 0.
    if (names[i] == kSubmapColumn) columns->counts.push_back({i, &RunFrame::submap});
    if (names[i].starts_with(kCostPrefix))
      columns->costs.push_back({i, std::string(names[i].substr(kCostPrefix.size()))});
    if (names[i].starts_with(kStagePrefix))
      columns->stages.push_back({i, std::string(PresentName(names[i].substr(kStagePrefix.size())))});
  }
  return missing;
}

// Empty: the row is right; else what is wrong with it.
std::string ParseFrame(std::string_view line, const FrameColumns& columns, RunFrame* frame) {
  const std::vector<std::string_view> fields = Split(line, ',');
  if (fields.size() != columns.size)
    return "a row has " + std::to_string(columns.size) + " columns, this one has " + std::to_string(fields.size());
  const auto state =
      std::find_if(EnumNames<TrackingState>::kNames.begin(), EnumNames<TrackingState>::kNames.end(),
                   [&](const auto& entry) { return entry.second == PresentName(fields[columns.state]); });
  if (state == EnumNames<TrackingState>::kNames.end()) return Quoted(fields[columns.state]) + " is not a state";
  frame->state = state->first;
  for (const auto& [column, value] : columns.counts)
    if (!ParseInt(fields[column], &(frame->*value)) || frame->*value < 0)
      return Quoted(fields[column]) + " is not a whole number";
  std::vector<std::pair<std::size_t, double*>> numbers;
  for (const auto& [column, value] : columns.numbers) numbers.emplace_back(column, &(frame->*value));
  frame->costs.reserve(columns.costs.size());
  for (const auto& [column, name] : columns.costs)
    numbers.emplace_back(column, &frame->costs.emplace_back(CostTerm{name}).value);
  frame->stage_ms.resize(columns.stages.size());
  for (std::size_t i = 0; i < columns.stages.size(); ++i)
    numbers.emplace_back(columns.stages[i].column, &frame->stage_ms[i]);
  for (const auto& [column, value] : numbers)
    if (!ParseFinite(fields[column], value)) return Quoted(fields[column]) + " is not a finite number";
  return {};
}

Status ReadFrames(const std::string& path, Run* run) {
  auto lines = LineReader::Open(path);
  if (!lines.ok()) return lines.status();
  std::string_view line;
  if (!lines->Next(&line) || !lines->ended()) return lines->End();  // killed before the first row
  FrameColumns columns;
  if (const std::string missing = FindColumns(line, &columns); !missing.empty())
    return lines->Error("the first line names no column " + Quoted(missing) + "; a run's has " +
                        std::string(kFrameColumnsBeforeCosts) + "," + std::string(kFrameColumnsAfterCosts));
  for (const auto& stage : columns.stages) run->stage_names.push_back(stage.name);
  while (lines->Next(&line)) {
    if (!lines->ended()) {
      ++run->cut_lines;
      break;
    }
    RunFrame frame;
    if (const std::string wrong = ParseFrame(line, columns, &frame); !wrong.empty()) return lines->Error(wrong);
    if (!run->frames.empty() && frame.frame_idx <= run->frames.back().frame_idx)
      return lines->Error("frame " + std::to_string(frame.frame_idx) + " is not after the row before");
    run->frames.push_back(std::move(frame));
  }
  return lines->End();
}

// Gives the poses the frames of frames.csv that were tracked.
Status NumberPoses(const std::string& path, Run* run) {
  std::vector<const RunFrame*> tracked;
  for (const RunFrame& frame : run->frames)
    if (HasPose(frame.state)) tracked.push_back(&frame);
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

Result<std::string> TrajectoryChecksum(const std::string& run_path) {
  const auto bytes = ReadFile(run_path + "/trajectory.txt");
  if (!bytes.ok()) return bytes.status();
  const auto checksum = crc32_z(0, reinterpret_cast<const Bytef*>(bytes->data()), bytes->size());
  std::array<char, 9> digits;
  std::snprintf(digits.data(), digits.size(), "%08x", static_cast<unsigned int>(checksum));
  return std::string(digits.data());
}

}  // namespace pliant
