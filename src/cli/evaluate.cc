// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <iostream>

#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/run_evaluation.h"

namespace pliant::cli {
namespace {

const Manual kManual = {
    "evaluate",
    "compare a run with the truth of its sequence",
    "Prints how far the points of a run lie from the true surface (the RMSE of the paper, plain and untrimmed, and the "
    "median), how far its camera path lies from the true one (ATE and RPE), and how long its tracks live. Beside every "
    "surface error stands its null: the same pixels at one constant depth, through the same evaluation. A figure that "
    "is "
    "not below its null says that nothing was reconstructed.\n\n"
    "Reads --run: a run folder that pliant track left, also one that was interrupted or killed, or another program's "
    "trajectory.txt and observations.csv. Reads --sequence: a native sequence with depth/, groundtruth.txt or both.\n\n"
    "Leaves, where --output_path is given: evaluation.json (every figure) and evaluation.csv (one row a frame).",
    {"pliant evaluate --run run --sequence colon",
     "pliant evaluate --run run --sequence colon --scale global --output_path run/evaluation"},
};

}  // namespace

int EvaluateCommand(std::span<const std::string> args) {
  std::string run_path;
  std::string sequence_path;
  std::string output_path;
  EvaluationOptions options;
  bool quiet = false;
  CommandLine line(kManual);
  line.Add("run", &run_path, "DIR", "run folder", Need::kRequired);
  line.Add("sequence", &sequence_path, "DIR", "native sequence with truth", Need::kRequired);
  line.AddAlias("scale", "SurfaceError.scale", "per_frame|global|none",
                "what a run is multiplied with: the best scale of each frame (the paper's protocol after a monocular "
                "start), one for all frames, or nothing (runs in true millimetres)");
  line.Add("output_path", &output_path, "DIR", "folder for evaluation.json and evaluation.csv", Need::kOptional);
  line.AddFlag("quiet", &quiet, "print no table");
  if (const auto exit = line.Parse(args)) return *exit;

  OptionTable table;
  options.List(table);
  if (const auto exit = line.Resolve(table)) return *exit;

  const Result<Evaluation> evaluation = EvaluateRun(run_path, sequence_path, options);
  Status status = evaluation.status();
  if (status.ok() && !output_path.empty()) status = WriteEvaluation(*evaluation, output_path);
  if (!status.ok()) {
    SayError(kManual.command, status.message());
    return kExitFailed;
  }
  if (!quiet) std::cout << EvaluationTable(*evaluation) << std::flush;
  return kExitOk;
}

}  // namespace pliant::cli
