// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A run in other programs' formats. COLMAP has no time axis for points, so a scene that deforms can be put into its
// models in three ways, none of which is consistent with bundle adjustment:
//   canonical   one point a track, at its undeformed position, and all images with their keypoints
//   spacetime   one point a track and frame, with id frame * 10^6 + track, colored by time; each is seen in one image
//   frames      a model a frame, in a folder of the frame's number: the points where they were then
// and others, which MeshLab, evo and COLMAP itself read:
//   ply           a file a frame: the points where they were then, with color, track id and displacement (dx dy dz)
//   trajectories  one PLY: every point in every frame, a track's joined by edges, colored by time
//   tum           trajectory.txt, with which evo compares
//   colmap4d      a spacetime model and its times: times.bin, points_t.bin, time_meta.json (colmap4d 1.0)
//   database      COLMAP's database (SQLite): tracks as keypoints and verified matches, from which COLMAP reconstructs
// Units are the run's (map units, mm). Observations are streamed: memory grows with points and frames, not with the
// number of observations.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/colmap/model.h"

namespace pliant {

enum class ExportFormat { kCanonical, kSpacetime, kFrames, kPly, kTrajectories, kTum, kColmap4d, kDatabase };

template <>
struct EnumNames<ExportFormat> {
  static constexpr std::array kNames = {std::pair{ExportFormat::kCanonical, std::string_view("canonical")},
                                        std::pair{ExportFormat::kSpacetime, std::string_view("spacetime")},
                                        std::pair{ExportFormat::kFrames, std::string_view("frames")},
                                        std::pair{ExportFormat::kPly, std::string_view("ply")},
                                        std::pair{ExportFormat::kTrajectories, std::string_view("trajectories")},
                                        std::pair{ExportFormat::kTum, std::string_view("tum")},
                                        std::pair{ExportFormat::kColmap4d, std::string_view("colmap4d")},
                                        std::pair{ExportFormat::kDatabase, std::string_view("database")}};
};

struct ExportOptions {
  colmap::Format files = colmap::Format::kBinary;  // of COLMAP's models
  int stride = 1;                                  // every Nth tracked frame is exported
  int min_matches = 15;                            // database: pairs of images that share fewer tracks are left out

  void List(OptionTable& table);  // group "Export"
};

struct ExportRequest {
  std::string run_path;
  // Where images' names and the camera are taken from if the run folder has no sparse/: a killed run, or another
  // program's. Empty: the images that the run was made of.
  std::string sequence_path;
  ExportFormat format = ExportFormat::kCanonical;
  std::string output_path;  // a folder, made if need be
};

struct ExportSummary {
  int frames = 0;
  int points = 0;
  std::int64_t observations = 0;
  std::vector<std::string> notes;  // what could not be known, a sentence each
};

// Fails with kNotFound, kUnreadable or kMismatch for what cannot be read; kInsufficient if no frame was tracked;
// kInvalidArgument if the folder has a model in another format; kUnwritable.
Result<ExportSummary> ExportRun(const ExportRequest& request, const ExportOptions& options);

}  // namespace pliant
