// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <functional>

#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/progress.h"
#include "cli/run_evaluation.h"
#include "pliant/evaluation/compare_runs.h"
#include "pliant/evaluation/report.h"
#include "pliant/viewer/comparison_figure.h"
#include "pliant/viewer/output.h"

namespace pliant::cli {
namespace {

const Manual kCompareManual = {
    "compare",
    "set runs side by side, and against the truth where there is one",
    "Prints two tables with a row a run. The first says what was reconstructed: frames with a pose, points in a frame, "
    "tracks and their mean length in frames, tracks that continue another one that had ended at the same point of "
    "the material (simulated sequences), the reprojection error of the run's own points, and the time it took. The "
    "second says how far it is from the truth, where the sequence has one: pliant evaluate --help explains its figures "
    "and their nulls. Without --sequence it says how far each run is from the first one: depths at the same pixels "
    "after one scale a frame, ATE after a similarity by the length of the path, and RPE from frame to frame.\n\n"
    "Reads --run, two or more: run folders that pliant track or pliant import left, or other systems' results. Reads "
    "--sequence, one for all of them, or one for each in their order, or none.\n\n"
    "Leaves, where --output_path is given: comparison.json, comparison.csv (one row a run), and evaluation.json and "
    "evaluation.csv of each run in 0/, 1/, ... in their order. Where --figure is given: a figure for a paper, one "
    "column (3.4 inches) wide, with the surface RMSE and its null, the camera error and the points of every frame, as "
    "far as the runs have them. A line has a gap where the run has no map.\n\n"
    "A run that cannot be evaluated is said on standard error; the others are compared, and the command ends with 1.",
    {"pliant compare --run ours --run rigid --sequence colon --figure comparison.pdf",
     "pliant compare --run ours --run theirs --sequence colon --protocol all --output_path comparison",
     "pliant compare --run ours --run theirs"},
};

}  // namespace

int CompareCommand(std::span<const std::string> args) {
  CompareRequest request;
  std::string output_path;
  std::string figure_path;
  EvaluationOptions options;
  CommandLine line(kCompareManual);
  line.Add("run", &request.run_paths, "DIR", "run folder", Need::kRequired, Positional::kYes);
  line.Add("sequence", &request.sequence_paths, "PATH",
           "the images, with truth where there is; one for all runs, or one for each; without it the runs are compared "
           "with the first one",
           Need::kOptional);
  AddEvaluationArguments(&line, &request.camera_path);
  line.Add("output_path", &output_path, "DIR", "folder for the JSON and CSV files", Need::kOptional);
  line.Add("figure", &figure_path, "FILE", "figure of the errors over the frames to write: .png, .svg or .pdf",
           Need::kOptional);
  if (const auto exit = line.Parse(args)) return *exit;

  OptionTable table;
  options.List(table);
  if (const auto exit = line.Resolve(table)) return *exit;
  if (const Status status = CheckCompareRequest(request); !status.ok()) return line.UsageError(status.message());
  if (!figure_path.empty())
    if (const Status status = CheckEnding(ViewOutput::kFigure, figure_path, "--figure"); !status.ok())
      return line.UsageError(status.message());

  const Result<RunComparison> comparison = [&] {
    JobBars bars(StopOnSignals());
    return CompareRuns(request, options, std::ref(bars));
  }();
  if (!comparison.ok()) return line.Failure(comparison.status().message());
  for (const Status& failure : comparison->failures) SayError(failure.message());
  if (!output_path.empty())
    if (const Status status = WriteRunComparison(*comparison, output_path); !status.ok())
      return line.Failure(status.message());
  const std::vector<Evaluation> evaluated = comparison->Evaluated();
  if (!evaluated.empty()) SayResult(ComparisonTable(evaluated));
  if (!evaluated.empty() && !figure_path.empty())
    if (const Status status = WriteComparisonFigure(evaluated, figure_path); !status.ok())
      return line.Failure(status.message());
  return comparison->failures.empty() ? kExitOk : kExitFailed;
}

}  // namespace pliant::cli
