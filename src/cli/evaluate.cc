// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <iostream>
#include <optional>

#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/run_evaluation.h"
#include "pliant/evaluation/report.h"

namespace pliant::cli {
namespace {

const Manual kManual = {
    "evaluate",
    "compare runs with the truth of their sequences",
    "Prints how far the points of a run lie from the true surface (the RMSE of the paper, plain and untrimmed, and the "
    "median), how far from the material points that they started on (simulated sequences: it tells drift apart from "
    "shape), how far the camera path lies from the true one (ATE and RPE), how good the first map was (relative error "
    "of its depths after one scale, in the frame that made it), and how long the tracks live. Beside every error of "
    "points stands its null: the same pixels at one constant depth, through the same evaluation. A figure that is not "
    "below its null says that nothing was reconstructed.\n\n"
    "--protocol compares the points in further ways of the literature: depth_trimmed (depth only, robust scale, the "
    "worst 5 % left out) and lmeds (least-median-of-squares scale, inliers). The plain figure is printed in any "
    "case.\n\n"
    "Reads --run: a run folder that pliant track left, also one that was interrupted or killed, or another system's "
    "trajectory.txt (TUM) and observations.csv; docs/formats.md says how to bring one. Reads --sequence: a native "
    "sequence with depth/, groundtruth.txt or simulation.yaml.\n\n"
    "Several runs: --run A --run B --sequence S, or with a --sequence for each run in the same order, gives one table "
    "with a row a run.\n\n"
    "Leaves, where --output_path is given: evaluation.json (every figure) and evaluation.csv (one row a frame). Of "
    "several runs: comparison.json and comparison.csv (one row a run), and the two files of each run in 0/, 1/, ... in "
    "their order.",
    {"pliant evaluate --run run --sequence colon",
     "pliant evaluate --run run --sequence colon --protocol all --scale global --output_path run/evaluation",
     "pliant evaluate --run ours --run theirs --sequence colon --output_path comparison"},
};

struct Request {
  std::vector<std::string> run_paths;
  std::vector<std::string> sequence_paths;  // one, or as many as runs
  std::string output_path;
};

// Evaluates every run; a sequence that several runs in a row share is opened once. A run that cannot be evaluated, and
// a sequence that cannot be opened, is told on standard error and leaves no evaluation; the others go on.
std::vector<std::optional<Evaluation>> EvaluateAll(const Request& request, const EvaluationOptions& options) {
  std::vector<std::optional<Evaluation>> evaluations(request.run_paths.size());
  std::optional<Result<OpenedTruth>> truth;
  std::string opened_path;
  for (std::size_t i = 0; i < request.run_paths.size(); ++i) {
    const std::string& sequence_path = request.sequence_paths[request.sequence_paths.size() == 1 ? 0 : i];
    if (!truth || sequence_path != opened_path) {
      truth = OpenTruth(sequence_path, options);
      opened_path = sequence_path;
      if (!truth->ok()) SayError(kManual.command, truth->status().message());
    }
    if (!truth->ok()) continue;
    Result<Evaluation> evaluation = EvaluateRun(request.run_paths[i], **truth, options);
    if (evaluation.ok())
      evaluations[i] = *std::move(evaluation);
    else
      SayError(kManual.command, evaluation.status().message());
  }
  return evaluations;
}

Status WriteAll(const std::vector<std::optional<Evaluation>>& evaluations, const std::vector<Evaluation>& good,
                const std::string& folder) {
  if (evaluations.size() == 1) return good.empty() ? Status::Ok() : WriteEvaluation(good.front(), folder);
  for (std::size_t i = 0; i < evaluations.size(); ++i)
    if (evaluations[i])
      if (Status status = WriteEvaluation(*evaluations[i], folder + "/" + std::to_string(i)); !status.ok())
        return status;
  if (Status status = WriteReport(folder, "comparison.json", ComparisonJson(good)); !status.ok()) return status;
  return WriteReport(folder, "comparison.csv", ComparisonCsv(good));
}

}  // namespace

int EvaluateCommand(std::span<const std::string> args) {
  Request request;
  EvaluationOptions options;
  bool quiet = false;
  CommandLine line(kManual);
  line.Add("run", &request.run_paths, "DIR", "run folder", Need::kRequired);
  line.Add("sequence", &request.sequence_paths, "DIR", "native sequence with truth; one for all runs, or one for each",
           Need::kRequired);
  line.AddAlias("protocol", "PointError.protocol", "paper|depth_trimmed|lmeds|all",
                "how points are compared: one, several with commas, or all");
  line.AddAlias("scale", "PointError.scale", "per_frame|global|none",
                "what a run is multiplied with: the best scale of each frame (the paper's protocol after a monocular "
                "start), one for all frames, or nothing (runs in true millimetres)");
  line.AddAlias("parts", "Evaluation.parts", "surface|material|camera|first_map|all",
                "what to compute: one, several with commas, or all; an error where there is no truth for it. Without "
                "it, all that there is truth for");
  line.Add("output_path", &request.output_path, "DIR", "folder for the JSON and CSV files", Need::kOptional);
  line.AddFlag("quiet", &quiet, "print no table");
  if (const auto exit = line.Parse(args)) return *exit;

  OptionTable table;
  options.List(table);
  if (const auto exit = line.Resolve(table)) return *exit;
  if (request.sequence_paths.size() != 1 && request.sequence_paths.size() != request.run_paths.size())
    return line.UsageError("--sequence is given " + std::to_string(request.sequence_paths.size()) + " times for " +
                           std::to_string(request.run_paths.size()) +
                           " runs; give one for all of them, or one for each");

  const std::vector<std::optional<Evaluation>> evaluations = EvaluateAll(request, options);
  std::vector<Evaluation> good;
  for (const std::optional<Evaluation>& evaluation : evaluations)
    if (evaluation) good.push_back(*evaluation);
  if (!request.output_path.empty()) {
    if (const Status status = WriteAll(evaluations, good, request.output_path); !status.ok()) {
      SayError(kManual.command, status.message());
      return kExitFailed;
    }
  }
  if (!quiet && !good.empty())
    std::cout << (evaluations.size() == 1 ? EvaluationTable(good.front()) : ComparisonTable(good)) << std::flush;
  return good.size() == evaluations.size() ? kExitOk : kExitFailed;
}

}  // namespace pliant::cli
