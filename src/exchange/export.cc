// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/exchange/export.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "exchange/exports.h"
#include "pliant/base/text.h"
#include "pliant/io/trajectory.h"

namespace pliant {
namespace {

Status Export(const RunSource& source, ExportFormat format, const std::string& folder, const ExportOptions& options) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return {ErrorCode::kUnwritable, "cannot make the folder " + Quoted(folder) + ": " + error.message()};
  switch (format) {
    case ExportFormat::kCanonical:
      return ExportCanonical(source, options, folder);
    case ExportFormat::kSpacetime:
      return ExportSpacetime(source, options, folder);
    case ExportFormat::kFrames:
      return ExportFrames(source, options, folder);
    case ExportFormat::kPly:
      return ExportPly(source, folder);
    case ExportFormat::kTrajectories:
      return ExportTrajectories(source, folder);
    case ExportFormat::kTum:
      return ExportTum(source, folder);
    case ExportFormat::kColmap4d:
      return ExportColmap4d(source, options, folder);
    case ExportFormat::kDatabase:
      return ExportDatabase(source, options, folder);
  }
  return Status::Ok();
}

}  // namespace

void ExportOptions::List(OptionTable& table) {
  table.BeginGroup("Export", "what is exported of a run");
  table.AddChoice("files", &files, "of COLMAP's models");
  table.Add("stride", &stride, "frames", "every Nth tracked frame", 1, 100000);
  table.Add("min_matches", &min_matches, "-", "database: images that share fewer tracks are not matched", 1, 1000000);
}

std::array<std::uint8_t, 3> TimeColor(const RunSource& source, const SourceFrame& frame) {
  // Nine of viridis' 256 colors, evenly spaced.
  constexpr std::array<std::array<double, 3>, 9> kColors = {{{68, 1, 84},
                                                             {71, 44, 122},
                                                             {59, 81, 139},
                                                             {44, 113, 142},
                                                             {33, 144, 141},
                                                             {39, 173, 129},
                                                             {92, 200, 99},
                                                             {170, 220, 50},
                                                             {253, 231, 37}}};
  const double first = source.frames.front().frame_idx;
  const double length = std::max(1.0, source.frames.back().frame_idx - first);
  const double position = (frame.frame_idx - first) / length * (kColors.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(position), kColors.size() - 2);
  std::array<std::uint8_t, 3> color{};
  for (std::size_t c = 0; c < 3; ++c)
    color[c] = static_cast<std::uint8_t>(
        std::lround(std::lerp(kColors[below][c], kColors[below + 1][c], position - static_cast<double>(below))));
  return color;
}

std::string NumberOf(const SourceFrame& frame) {
  std::string text = std::to_string(frame.frame_idx);
  return text.insert(0, 6 - std::min<std::size_t>(6, text.size()), '0');
}

Status ExportTum(const RunSource& source, const std::string& folder) {
  std::string lines;
  for (const SourceFrame& frame : source.frames)
    AppendTumLine(&lines, frame.timestamp_s, frame.cam_from_world.Inverse());
  return WriteFileAtomically(folder + "/trajectory.txt", lines);
}

Result<ExportSummary> ExportRun(const ExportRequest& request, const ExportOptions& options) {
  const auto sources = ReadRunSources(request.run_path, request.sequence_path, options.stride);
  if (!sources.ok()) return sources.status();
  ExportSummary summary;
  for (std::size_t k = 0; k < sources->size(); ++k) {
    const RunSource& source = (*sources)[k];
    const std::string folder =
        sources->size() > 1 ? request.output_path + "/" + std::to_string(k) : request.output_path;
    if (Status status = Export(source, request.format, folder, options); !status.ok()) return status;
    summary.frames += static_cast<int>(source.frames.size());
    summary.points += static_cast<int>(source.points.size());
    summary.observations += source.num_observations;
    summary.notes.insert(summary.notes.end(), source.notes.begin(), source.notes.end());
  }
  if (sources->size() > 1)
    summary.notes.push_back("the run has " + std::to_string(sources->size()) +
                            " submaps, each with its own world and unit: one folder each");
  return summary;
}

}  // namespace pliant
