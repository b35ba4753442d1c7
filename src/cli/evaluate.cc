// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <iostream>

#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/run_evaluation.h"
#include "pliant/datasets/run_sequence.h"
#include "pliant/evaluation/report.h"

namespace pliant::cli {
namespace {

const Manual kManual = {
    "evaluate",
    "compare a run with the truth of its sequence",
    "Prints how far the points of a run lie from the true surface (the RMSE of the paper, untrimmed, and the "
    "median), how far from the material points that they started on (simulated sequences: this separates drift from "
    "errors of shape), how far the camera path lies from the true one (ATE and RPE), how good the first map was "
    "(relative error "
    "of its depths after one scale, in the frame that made it), and how long the tracks live. Beside every error of "
    "points stands its null: the same pixels at one constant depth, through the same evaluation. If a figure is not "
    "below its null, nothing was reconstructed.\n\n"
    "--protocol compares the points in further ways of the literature: depth_trimmed (depth only, robust scale, the "
    "worst 5 % left out) and lmeds (least-median-of-squares scale, inliers). The plain figure is printed in any "
    "case.\n\n"
    "Reads --run: a run folder that pliant track left, also one that was interrupted or killed, or another system's "
    "trajectory.txt (TUM) and observations.csv; docs/formats.md says how to bring one. Reads --sequence: a "
    "sequence with depth images, poses, pairs of images (the disparity at every point is then the truth of the "
    "surface, with its own uncertainty) or simulation.yaml; without any of these only tracks and reprojection are "
    "evaluated.\n\n"
    "Leaves, where --output_path is given: evaluation.json (every figure) and evaluation.csv (one row a frame). "
    "pliant compare sets several runs side by side.",
    {"pliant evaluate --run run --sequence colon",
     "pliant evaluate --run run --sequence clip.mp4 --camera stereo.yaml --scale none",
     "pliant evaluate --run run --sequence colon --protocol all --scale global --output_path run/evaluation"},
};

}  // namespace

int EvaluateCommand(std::span<const std::string> args) {
  std::string run_path;
  std::string sequence_path;
  std::string camera_path;
  std::string output_path;
  EvaluationOptions options;
  bool quiet = false;
  CommandLine line(kManual);
  line.Add("run", &run_path, "DIR", "run folder", Need::kRequired);
  line.Add("sequence", &sequence_path, "PATH", "sequence with truth: a folder, or a video of pairs", Need::kRequired);
  AddEvaluationArguments(&line, &camera_path);
  line.Add("output_path", &output_path, "DIR", "folder for the JSON and CSV files", Need::kOptional);
  line.AddFlag("quiet", &quiet, "print no table");
  if (const auto exit = line.Parse(args)) return *exit;
  OptionTable table;
  options.List(table);
  if (const auto exit = line.Resolve(table)) return *exit;

  const auto truth = OpenTruth(SequenceOfRun(run_path, sequence_path, camera_path), options);
  if (!truth.ok()) return line.Failure(truth.status().message());
  const auto evaluation = EvaluateRun(run_path, *truth, options);
  if (!evaluation.ok()) return line.Failure(evaluation.status().message());
  if (!output_path.empty())
    if (const Status status = WriteEvaluation(*evaluation, output_path); !status.ok())
      return line.Failure(status.message());
  if (!quiet) std::cout << EvaluationTable(*evaluation) << std::flush;
  return kExitOk;
}

}  // namespace pliant::cli
