// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <optional>

#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/frame_list.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/output_folder.h"
#include "cli/progress.h"
#include "cli/sequence_arguments.h"
#include "pliant/base/text.h"
#include "pliant/pipeline/surface_run.h"

namespace pliant::cli {
namespace {

const Manual kSurfaceManual = {
    "surface",
    "dense depth of every frame of a run",
    "Reads --run: a run folder that pliant track or pliant refine left, and its images. The depth at every pixel is "
    "found by comparing the frame with others, which are seen through the deformation: a point moves as the tracked "
    "points around it.\n\n"
    "Leaves in --output_path depth/ (16-bit PNG, times depth_scale of camera.yaml, map units; 0: not known), "
    "confidence/ (standard deviation by the depth, times 65535) and surface.json. Where images say nothing of the "
    "depth "
    "(highlights, no texture, unseen from elsewhere) there is none, unless --Surface.fill fills small holes, which "
    "filled/ marks. Then one mesh of all that was seen, whose vertices "
    "move with the tissue: mesh/ (what a frame shows of it, PLY), undeformed.ply, surface.glb (textured and animated, "
    "for Blender and browsers), surface.pvd and vtp/ (displacement and strain, for ParaView).",
    {"pliant surface --run run --output_path surface",
     "pliant surface --run run --frames 10,20,30 --output_path surface"},
};

}  // namespace

int SurfaceCommand(std::span<const std::string> args) {
  SurfaceRequest request;
  SurfaceRunOptions options;
  OutputFolder output;
  std::string frames;
  CommandLine line(kSurfaceManual);
  line.Add("run", &request.run_path, "DIR", "run folder", Need::kRequired, Positional::kYes);
  output.AddTo(&line, "folder to write, made if need be", Need::kRequired);
  line.Add("sequence", &request.sequence_path, "PATH", "the run's images; without it those that its run.json names",
           Need::kOptional);
  AddCameraOfRun(&line, &request.camera_path);
  AddMasksOfRun(&line, &request.mask_path);
  line.Add("frames", &frames, "FRAMES", "their numbers, with commas; 10-20 are all from 10 to 20; without it all",
           Need::kOptional);
  if (const auto exit = line.Parse(args)) return *exit;
  OptionTable table;
  options.List(table);
  if (const auto exit = line.Resolve(table)) return *exit;

  const auto chosen = ParseFrameList("--frames", frames);
  if (!chosen.ok()) return line.UsageError(chosen.status().message());
  request.frames = *chosen;
  if (const auto exit = output.Check(line, output.path, OutputFolder::Content::kSurface)) return *exit;
  request.output_path = output.path;
  request.command_line = line.Words(args);
  request.stop = &StopOnSignals();
  std::optional<Progress> depths;
  std::optional<Progress> mesh;
  const auto summary = MakeSurface(request, options, [&](SurfaceStage stage, int done, int total, double known_share) {
    if (stage == SurfaceStage::kDepth) {
      if (!depths) depths.emplace("depth", total);
      depths->Update(done, Percent(known_share) + " known");
    } else {
      depths.reset();
      if (!mesh) mesh.emplace("mesh", total);
      mesh->Update(done, "");
    }
  });
  depths.reset();
  mesh.reset();
  if (!summary.ok()) return line.Failure(summary.status());
  for (const std::string& warning : summary->warnings) SayWarning(warning);
  if (summary->stopped)
    return line.Failure("stopped on request; the depths of " + std::to_string(summary->frames.size()) +
                        " frames are in " + request.output_path + ", and the meshes are not complete");
  SayResult(request.output_path);
  return kExitOk;
}

}  // namespace pliant::cli
