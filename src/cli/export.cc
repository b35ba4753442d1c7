// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/exchange/export.h"

#include <iostream>

#include "cli/command_line.h"
#include "cli/commands.h"

namespace pliant::cli {
namespace {

const Manual kManual = {
    "export",
    "write a run in other programs' formats",
    "Reads --run: a run folder that pliant track left, also one that was interrupted or killed. Then the camera and "
    "the "
    "images' names are taken from the sequence that it was made of, or from --sequence.\n\n"
    "Leaves in --output_path, by --format:\n\n"
    "canonical: a COLMAP model with one point a track at its undeformed position, all images, their keypoints and "
    "tracks. The scene moved, so it is not consistent with bundle adjustment.\n\n"
    "spacetime: a COLMAP model with one point a track and frame, colored by time (early is dark, late is yellow); its "
    "id is frame * 1000000 + track. COLMAP's viewer hides points with short tracks: set its minimum track length to "
    "1.\n\n"
    "frames: a COLMAP model a frame, in folders 000000, 000001, ..., with the points where they were then.\n\n"
    "ply: a file a frame, with color, track id and the displacement dx, dy, dz from the undeformed position.\n\n"
    "trajectories: trajectories.ply, every point in every frame, those of a track joined by edges.\n\n"
    "tum: trajectory.txt, the camera's path, which evo reads.\n\n"
    "colmap4d: spacetime with times.bin, points_t.bin and time_meta.json.\n\n"
    "database: database.db with tracks as keypoints and verified matches, from which COLMAP's mapper, "
    "point_triangulator and bundle_adjuster reconstruct; made by the COLMAP that is installed.",
    {"pliant export --run run --format spacetime --output_path spacetime",
     "pliant export --run run --format canonical --output_path text --Export.files text",
     "pliant export --run run --format database --output_path colmap"},
};

}  // namespace

int ExportCommand(std::span<const std::string> args) {
  ExportRequest request;
  ExportOptions options;
  bool quiet = false;
  CommandLine line(kManual);
  line.Add("run", &request.run_path, "DIR", "run folder", Need::kRequired);
  line.AddChoice("format", &request.format, "what to write");
  line.Add("output_path", &request.output_path, "DIR", "folder to write, made if need be", Need::kRequired);
  line.Add("sequence", &request.sequence_path, "PATH",
           "images of a run that has no sparse/; without it those that its run.json names", Need::kOptional);
  line.AddFlag("quiet", &quiet, "say nothing but errors");
  if (const auto exit = line.Parse(args)) return *exit;
  OptionTable table;
  options.List(table);
  if (const auto exit = line.Resolve(table)) return *exit;

  const auto summary = ExportRun(request, options);
  if (!summary.ok()) return line.Failure(summary.status().message());
  if (quiet) return kExitOk;
  for (const std::string& note : summary->notes) std::cout << "note: " << note << "\n";
  std::cout << summary->frames << " frames, " << summary->points << " points, " << summary->observations
            << " observations in " << request.output_path << "\n";
  return kExitOk;
}

}  // namespace pliant::cli
