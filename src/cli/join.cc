// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <functional>

#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/output_folder.h"
#include "cli/progress.h"
#include "cli/sequence_arguments.h"
#include "pliant/base/text.h"
#include "pliant/pipeline/join_runs.h"

namespace pliant::cli {
namespace {

const Manual kJoinManual = {
    "join",
    "one run of runs of parts of a recording, which overlap",
    "Reads --run, two or more: run folders that pliant track left of parts of one recording (--start, --end). Parts "
    "that follow each other have frames in common: 30 to 100 are enough. In these their cameras and the depths of "
    "points at the same pixels tell how their worlds lie to each other; points that are at one place in most of them "
    "are one. Where the parts have no map in common the later one's is a submap of its own.\n\n"
    "Leaves in --output_path a run folder, in the world and unit of the first part. Nothing is solved for again: "
    "pliant refine does.",
    {"pliant join --run part_0 --run part_1 --run part_2 --output_path whole"},
};

void Say(const RunJoint& joint) {
  const std::string runs = joint.run + " to " + joint.before + ": ";
  if (!joint.failure.empty()) {
    SayNote(runs + "not joined, its map is a submap of its own: " + joint.failure);
    return;
  }
  SayResult(runs + std::to_string(joint.frames) + " common frames, " + std::to_string(joint.points) +
            " pairs of points, scale " + Digits(joint.scale, 3) + ", depths differ by " +
            Digits(100.0 * joint.depth_difference, 1) + " % (spread " + Digits(100.0 * joint.depth_spread, 1) +
            " %), " + std::to_string(joint.same_points) + " points are the same");
}

}  // namespace

int JoinCommand(std::span<const std::string> args) {
  JoinRequest request;
  JoinOptions options;
  OutputFolder output;
  CommandLine line(kJoinManual);
  line.Add("run", &request.run_paths, "DIR", "run folder of a part, in any order", Need::kRequired, Positional::kYes);
  output.AddTo(&line, "folder to write, made if need be", Need::kRequired);
  AddSequenceOfKilledRun(&line, &request.sequence_path, &request.camera_path);
  if (const auto exit = line.Parse(args)) return *exit;
  OptionTable table;
  options.List(table);
  if (const auto exit = line.Resolve(table)) return *exit;
  if (request.run_paths.size() < 2) return line.UsageError("two or more runs are joined: give --run twice");

  request.output_path = output.path;
  if (const Status status = CheckPaths(request); !status.ok()) return line.UsageError(status.message());
  if (const auto exit = output.Check(line, output.path, OutputFolder::Content::kRun)) return *exit;
  request.command_line = line.Words(args);
  const auto summary = [&] {
    JobBars bars(StopOnSignals());
    return JoinRuns(request, options, std::ref(bars));
  }();
  if (!summary.ok()) return line.Failure(summary.status().message());
  for (const RunJoint& joint : summary->joints) Say(joint);
  SayResult(std::to_string(summary->run.frames_tracked) + " of " + std::to_string(summary->run.frames_read) +
            " frames, " + std::to_string(summary->run.submaps) + (summary->run.submaps == 1 ? " map" : " submaps") +
            " in " + request.output_path);
  return kExitOk;
}

}  // namespace pliant::cli
