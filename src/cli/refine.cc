// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/output_folder.h"
#include "cli/run_refinement.h"
#include "cli/sequence_arguments.h"

namespace pliant::cli {
namespace {

const Manual kRefineManual = {
    "refine",
    "solve for all frames of a run at once",
    "Reads --run: a run folder that pliant track or pliant import left. Tracking knows only the frames before; here "
    "all camera poses, all points and the motion of the scene are solved for together, from the tracks of the whole "
    "run.\n\n"
    "Leaves in --output_path a run folder that evaluate, compare, export and report read like the run's own, with how "
    "certain its points (sigma_mm) and poses (pose_covariance.csv) are. Nothing is written before the refinement is "
    "done; Ctrl-C ends it with the last solution of all frames, if there is one.",
    {"pliant refine --run run --output_path refined",
     "pliant refine --run run --Refine.model rigid --output_path rigid"},
};

}  // namespace

int RefineCommand(std::span<const std::string> args) {
  RefineRequest request;
  RefineOptions options;
  OutputFolder output;
  CommandLine line(kRefineManual);
  line.Add("run", &request.run_path, "DIR", "run folder", Need::kRequired, Positional::kYes);
  output.AddTo(&line, "folder to write, made if need be", Need::kRequired);
  AddSequenceOfKilledRun(&line, &request.sequence_path, &request.camera_path);
  if (const auto exit = line.Parse(args)) return *exit;
  OptionTable table;
  options.List(table);
  if (const auto exit = line.Resolve(table)) return *exit;

  request.output_path = output.path;
  if (const Status status = CheckPaths(request); !status.ok()) return line.UsageError(status.message());
  if (const auto exit = output.Check(line, output.path, OutputFolder::Content::kRun)) return *exit;
  request.command_line = line.Words(args);
  request.stop = &StopOnSignals();
  return RefineAndSay(request, options);
}

}  // namespace pliant::cli
