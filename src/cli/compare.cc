// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <filesystem>
#include <functional>
#include <map>
#include <optional>

#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/progress.h"
#include "cli/run_evaluation.h"
#include "pliant/datasets/run_sequence.h"
#include "pliant/evaluation/evaluate_run.h"
#include "pliant/evaluation/report.h"
#include "pliant/viewer/comparison_figure.h"
#include "pliant/viewer/output.h"

namespace pliant::cli {
namespace {

const Manual kManual = {
    "compare",
    "set runs side by side, and against the truth where there is one",
    "Prints two tables with a row a run. The first says what was reconstructed: frames with a pose, points in a frame, "
    "tracks and their mean length in frames, tracks that continue another one that had ended at the same point of "
    "the material (simulated sequences), the reprojection error of the run's own points, and the time it took. The "
    "second says how far it is from the truth, where the sequence has one: pliant evaluate --help explains its figures "
    "and their nulls.\n\n"
    "Reads --run, two or more: run folders that pliant track or pliant import left, or other systems' results. Reads "
    "--sequence, one for all of them, or one for each in their order.\n\n"
    "Leaves, where --output_path is given: comparison.json, comparison.csv (one row a run), and evaluation.json and "
    "evaluation.csv of each run in 0/, 1/, ... in their order. Where --figure is given: a figure for a paper, one "
    "column (3.4 inches) wide, with the surface RMSE and its null, the camera error and the points of every frame, as "
    "far as the runs have them. A line has a gap where the run has no map.\n\n"
    "A run that cannot be evaluated is said on standard error; the others are compared, and the command ends with 1.",
    {"pliant compare --run ours --run rigid --sequence colon --figure comparison.pdf",
     "pliant compare --run ours --run theirs --sequence colon --protocol all --output_path comparison"},
};

struct Request {
  std::vector<std::string> run_paths;
  std::vector<std::string> sequence_paths;  // one, or as many as runs
  std::string camera_path;
  std::string output_path;
  std::string figure_path;
};

// A run that does not say its calibration takes that of another one of the same images.
std::vector<SequenceRequest> SequencesOf(const Request& request) {
  std::vector<SequenceRequest> sequences;
  std::map<std::filesystem::path, std::filesystem::path> spare_of;
  for (std::size_t i = 0; i < request.run_paths.size(); ++i) {
    const std::string& path = request.sequence_paths[request.sequence_paths.size() == 1 ? 0 : i];
    sequences.push_back(SequenceOfRun(request.run_paths[i], path, request.camera_path));
    if (!sequences.back().spare_camera_path.empty()) spare_of.emplace(path, sequences.back().spare_camera_path);
  }
  for (SequenceRequest& sequence : sequences)
    if (const auto spare = spare_of.find(sequence.image_path);
        spare != spare_of.end() && sequence.spare_camera_path.empty())
      sequence.spare_camera_path = spare->second;
  return sequences;
}

// A sequence that several runs in a row share is opened once.
std::vector<std::optional<Evaluation>> EvaluateAll(const Request& request, const EvaluationOptions& options) {
  std::vector<std::optional<Evaluation>> evaluations(request.run_paths.size());
  std::optional<Result<OpenedTruth>> truth;
  const std::vector<SequenceRequest> sequences = SequencesOf(request);
  JobBars bars(StopOnSignals());
  for (std::size_t i = 0; i < request.run_paths.size(); ++i) {
    if (!truth || sequences[i].image_path != sequences[i - 1].image_path ||
        sequences[i].spare_camera_path != sequences[i - 1].spare_camera_path) {
      truth = OpenTruth(sequences[i], options);
      if (!truth->ok()) SayError(truth->status().message());
    }
    if (!truth->ok()) continue;
    Result<Evaluation> evaluation = EvaluateRun(request.run_paths[i], **truth, options, std::ref(bars));
    if (evaluation.ok())
      evaluations[i] = *std::move(evaluation);
    else
      SayError(evaluation.status().message());
  }
  return evaluations;
}

Status WriteAll(const std::vector<std::optional<Evaluation>>& evaluations, const std::vector<Evaluation>& good,
                const std::string& folder) {
  for (std::size_t i = 0; i < evaluations.size(); ++i)
    if (evaluations[i])
      if (Status status = WriteEvaluation(*evaluations[i], folder + "/" + std::to_string(i)); !status.ok())
        return status;
  return WriteComparison(good, folder);
}

}  // namespace

int CompareCommand(std::span<const std::string> args) {
  Request request;
  EvaluationOptions options;
  CommandLine line(kManual);
  line.Add("run", &request.run_paths, "DIR", "run folder", Need::kRequired);
  line.Add("sequence", &request.sequence_paths, "PATH",
           "the images, with truth where there is; one for all runs, or one for each", Need::kRequired);
  AddEvaluationArguments(&line, &request.camera_path);
  line.Add("output_path", &request.output_path, "DIR", "folder for the JSON and CSV files", Need::kOptional);
  line.Add("figure", &request.figure_path, "FILE", "figure of the errors over the frames to write: .png, .svg or .pdf",
           Need::kOptional);
  if (const auto exit = line.Parse(args)) return *exit;

  OptionTable table;
  options.List(table);
  if (const auto exit = line.Resolve(table)) return *exit;
  if (request.sequence_paths.size() != 1 && request.sequence_paths.size() != request.run_paths.size())
    return line.UsageError("--sequence is given " + std::to_string(request.sequence_paths.size()) + " times for " +
                           std::to_string(request.run_paths.size()) +
                           " runs; give one for all of them, or one for each");
  if (!request.figure_path.empty())
    if (const Status status = CheckEnding(ViewOutput::kFigure, request.figure_path); !status.ok())
      return line.UsageError(status.message());

  const std::vector<std::optional<Evaluation>> evaluations = EvaluateAll(request, options);
  std::vector<Evaluation> good;
  for (const std::optional<Evaluation>& evaluation : evaluations)
    if (evaluation) good.push_back(*evaluation);
  if (!request.output_path.empty())
    if (const Status status = WriteAll(evaluations, good, request.output_path); !status.ok())
      return line.Failure(status.message());
  if (!good.empty()) SayResult(ComparisonTable(good));
  if (!good.empty() && !request.figure_path.empty())
    if (const Status status = WriteComparisonFigure(good, request.figure_path); !status.ok())
      return line.Failure(status.message());
  return good.size() == evaluations.size() ? kExitOk : kExitFailed;
}

}  // namespace pliant::cli
