// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/pipeline/join_runs.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <map>
#include <system_error>
#include <utility>

#include "io/staged_run.h"
#include "pipeline/joined_reports.h"
#include "pipeline/part_joiner.h"
#include "pipeline/run_frames.h"
#include "pipeline/run_parts.h"
#include "pliant/base/text.h"
#include "pliant/base/version.h"
#include "pliant/io/run_writer.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// Those that are not there yet.
void AddNames(const std::vector<std::string>& names, std::vector<std::string>* all) {
  for (const std::string& name : names)
    if (std::ranges::find(*all, name) == all->end()) all->push_back(name);
}

RunDescription JoinedDescription(const JoinRequest& request, const std::vector<RunPart>& parts) {
  RunDescription description = parts.front().description();
  description.program_version = kVersion;
  description.command_line = request.command_line;
  description.refined_from.clear();
  description.refinement.reset();
  description.joined_from.clear();
  for (const RunPart& part : parts) {
    const RunDescription& of_part = part.description();
    description.joined_from.push_back(fs::absolute(part.path).lexically_normal().string());
    const bool is_open = description.range.end == -1 || of_part.range.end == -1;
    description.range.end = is_open ? -1 : std::max(description.range.end, of_part.range.end);
    AddNames(of_part.oracles, &description.oracles);
    AddNames(of_part.extensions, &description.extensions);
    AddNames(of_part.warnings, &description.warnings);
    if (description.depth_prior.empty()) description.depth_prior = of_part.depth_prior;
    if (description.tracks.empty()) description.tracks = of_part.tracks;
  }
  return description;
}

// The last part's, unless an earlier one did not come to its end.
Status FinishAsParts(const std::vector<RunPart>& parts, RunWriter* writer) {
  for (const RunPart& part : parts) {
    const RunSummary& of_part = *part.run.summary;
    if (of_part.status == RunStatus::kFailed || of_part.status == RunStatus::kInterrupted)
      return writer->Finish(of_part.status, "of the part " + part.path + ": " + of_part.note);
  }
  return writer->Finish(parts.back().run.summary->status, parts.back().run.summary->note);
}

Result<RunSummary> WriteJoined(const JoinRequest& request, const JoinOptions& options,
                               const std::vector<RunPart>& parts, const PartJoiner& joiner,
                               const JobProgress& progress) {
  OptionTable table;
  JoinOptions listed = options;
  listed.List(table);
  RunWriterOptions writer_options;
  writer_options.total_s = 0.0;
  for (const RunPart& part : parts) *writer_options.total_s += part.run.summary->total_s;
  auto staged = StagedRun::Create(request.output_path);
  if (!staged.ok()) return staged.status();
  auto writer = RunWriter::Create(staged->path(), *parts.front().known.camera, JoinedDescription(request, parts),
                                  table.ToYaml(), {}, writer_options);
  if (!writer.ok()) return writer.status();
  std::vector<ObservationReader> readers;
  for (const RunPart& part : parts) {
    auto opened = ObservationReader::Open(part.path);
    if (!opened.ok()) return opened.status();
    readers.push_back(*std::move(opened));
  }
  JoinedReports reports(parts, joiner);
  const std::map<int, std::size_t> frames = PartOfFrames(parts);
  int done = 0;
  for (const auto& [frame_idx, part] : frames) {
    if (Status status = Tell(progress, "write", done++, static_cast<int>(frames.size())); !status.ok()) return status;
    auto seen = readers[part].Of(frame_idx);
    if (!seen.ok()) return seen.status();
    if (Status status = writer->Write(reports.Report(part, frame_idx, *std::move(seen))); !status.ok()) return status;
  }
  if (Status status = FinishAsParts(parts, &*writer); !status.ok()) return status;
  if (Status status = staged->Commit(); !status.ok()) return status;
  return writer->summary();
}

}  // namespace

void JoinOptions::List(OptionTable& table) {
  table.BeginGroup("Join", "how runs of parts of a recording are joined");
  table.Add("max_distance", &max_distance, "of the image's width", "between two points whose depths are compared", 1e-4,
            1);
  table.Add("min_points", &min_points, "points", "compared in the common frames of two parts", 1, 1000000);
  table.Add("max_depth_difference", &max_depth_difference, "-",
            "median difference of these depths, as a share of them; above it nothing is joined", 0, 10);
  table.Add("max_same_distance", &max_same_distance, "of the image's width",
            "between two points that are one, in most frames in which both are seen", 1e-5, 1);
}

Status CheckPaths(const JoinRequest& request) {
  if (request.run_paths.size() < 2) return {ErrorCode::kInvalidArgument, "two or more runs are joined; give more"};
  for (std::size_t i = 0; i < request.run_paths.size(); ++i) {
    if (Status status = CheckOutsideOfRun(request.run_paths[i], request.output_path, "joined"); !status.ok())
      return status;
    std::error_code error;
    for (std::size_t j = 0; j < i; ++j)
      if (fs::equivalent(request.run_paths[i], request.run_paths[j], error))
        return {ErrorCode::kInvalidArgument, "the run " + Quoted(request.run_paths[i]) + " was given twice"};
  }
  return Status::Ok();
}

Result<JoinSummary> JoinRuns(const JoinRequest& request, const JoinOptions& options, const JobProgress& progress) {
  if (Status status = CheckPaths(request); !status.ok()) return status;
  auto parts = ReadParts(request, progress);
  if (!parts.ok()) return parts.status();
  PartJoiner joiner(&*parts, options);
  const auto joints = static_cast<int>(parts->size()) - 1;
  for (int i = 1; i <= joints; ++i) {
    if (Status status = joiner.Join(static_cast<std::size_t>(i)); !status.ok()) return status;
    if (Status status = Tell(progress, "join", i, joints); !status.ok()) return status;
  }
  auto written = WriteJoined(request, options, *parts, joiner, progress);
  if (!written.ok()) return written.status();
  return JoinSummary{joiner.TakeJoints(), *std::move(written)};
}

}  // namespace pliant
