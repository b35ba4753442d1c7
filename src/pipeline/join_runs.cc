// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/pipeline/join_runs.h"

#include <cstddef>
#include <filesystem>
#include <system_error>
#include <utility>

#include "pipeline/joined_reports.h"
#include "pipeline/part_joiner.h"
#include "pipeline/run_parts.h"
#include "pliant/base/text.h"
#include "pliant/base/version.h"
#include "pliant/io/run_writer.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

Status CheckRunPaths(const JoinRequest& request) {
  if (request.run_paths.size() < 2) return {ErrorCode::kInvalidArgument, "two or more runs are joined; give more"};
  for (std::size_t i = 0; i < request.run_paths.size(); ++i) {
    std::error_code error;
    if (fs::equivalent(request.run_paths[i], request.output_path, error))
      return {ErrorCode::kInvalidArgument, "the joined run would overwrite the run " + Quoted(request.run_paths[i]) +
                                               "; give another --output_path"};
    for (std::size_t j = 0; j < i; ++j)
      if (fs::equivalent(request.run_paths[i], request.run_paths[j], error))
        return {ErrorCode::kInvalidArgument, "the run " + Quoted(request.run_paths[i]) + " was given twice"};
  }
  return Status::Ok();
}

RunDescription JoinedDescription(const JoinRequest& request, const std::vector<RunPart>& parts) {
  RunDescription description = parts.front().description();
  description.program_version = kVersion;
  description.command_line = request.command_line;
  description.refined_from.clear();
  description.joined_from.clear();
  for (const RunPart& part : parts)
    description.joined_from.push_back(fs::absolute(part.path).lexically_normal().string());
  description.range.end = parts.back().description().range.end;
  return description;
}

Result<RunSummary> WriteJoined(const JoinRequest& request, const JoinOptions& options,
                               const std::vector<RunPart>& parts, const PartJoiner& joiner) {
  OptionTable table;
  JoinOptions listed = options;
  listed.List(table);
  RunWriterOptions writer_options;
  writer_options.total_s = 0.0;
  for (const RunPart& part : parts) *writer_options.total_s += part.run.summary->total_s;
  auto writer = RunWriter::Create(request.output_path, *parts.front().known.camera, JoinedDescription(request, parts),
                                  table.ToYaml(), {}, writer_options);
  if (!writer.ok()) return writer.status();
  std::vector<ObservationReader> readers;
  for (const RunPart& part : parts) {
    auto opened = ObservationReader::Open(part.path);
    if (!opened.ok()) return opened.status();
    readers.push_back(*std::move(opened));
  }
  JoinedReports reports(parts, joiner);
  for (const auto& [frame_idx, part] : PartOfFrames(parts)) {
    auto seen = readers[part].Of(frame_idx);
    if (!seen.ok()) return seen.status();
    if (Status status = writer->Write(reports.Report(part, frame_idx, *std::move(seen))); !status.ok()) return status;
  }
  const RunSummary& last = *parts.back().run.summary;
  if (Status status = writer->Finish(last.status, last.note); !status.ok()) return status;
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

Result<JoinSummary> JoinRuns(const JoinRequest& request, const JoinOptions& options, const JobProgress& progress) {
  if (Status status = CheckRunPaths(request); !status.ok()) return status;
  auto parts = ReadParts(request, progress);
  if (!parts.ok()) return parts.status();
  PartJoiner joiner(&*parts, options);
  const auto joints = static_cast<int>(parts->size()) - 1;
  for (int i = 1; i <= joints; ++i) {
    if (Status status = joiner.Join(static_cast<std::size_t>(i)); !status.ok()) return status;
    if (Status status = Tell(progress, "join", i, joints); !status.ok()) return status;
  }
  auto written = WriteJoined(request, options, *parts, joiner);
  if (!written.ok()) return written.status();
  return JoinSummary{joiner.TakeJoints(), *std::move(written)};
}

}  // namespace pliant
