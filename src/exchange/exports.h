// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What ExportFormats lists, each from a run's source into a folder that is there, whose files ExportRun lets appear
// together when all are written.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "exchange/run_source.h"
#include "pliant/base/status.h"
#include "pliant/exchange/export.h"

namespace pliant {

struct ExportFolder {
  std::string path;   // where files are written
  std::string place;  // where they are moved when everything is written

  std::string Path(const std::string& name) const { return path + "/" + name; }
  // Makes a subfolder. Fails with kUnwritable.
  Status AddFolder(const std::string& name) const;
};

Status ExportColmapCanonical(const RunSource& source, const ExportOptions& options, const ExportFolder& folder);
Status ExportColmapSpacetime(const RunSource& source, const ExportOptions& options, const ExportFolder& folder);
Status ExportColmapFrames(const RunSource& source, const ExportOptions& options, const ExportFolder& folder);
Status ExportPly(const RunSource& source, const ExportOptions& options, const ExportFolder& folder);
Status ExportTrajectories(const RunSource& source, const ExportOptions& options, const ExportFolder& folder);
Status ExportTum(const RunSource& source, const ExportOptions& options, const ExportFolder& folder);
Status ExportColmap4d(const RunSource& source, const ExportOptions& options, const ExportFolder& folder);
Status ExportDatabase(const RunSource& source, const ExportOptions& options, const ExportFolder& folder);
Status ExportTracksCsv(const RunSource& source, const ExportOptions& options, const ExportFolder& folder);
Status ExportTracksNpz(const RunSource& source, const ExportOptions& options, const ExportFolder& folder);
Status ExportStir(const RunSource& source, const ExportOptions& options, const ExportFolder& folder);
Status ExportNerfstudio(const RunSource& source, const ExportOptions& options, const ExportFolder& folder);
Status ExportEndoNerf(const RunSource& source, const ExportOptions& options, const ExportFolder& folder);

// The color of a frame's time, from the source's first frame to its last: viridis, which is even to the eye and to the
// color-blind.
std::array<std::uint8_t, 3> TimeColor(const RunSource& source, const SourceFrame& frame);

// The frame's number as files and folders are called: 000123.
std::string NumberOf(const SourceFrame& frame);

}  // namespace pliant
