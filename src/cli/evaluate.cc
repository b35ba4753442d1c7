// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <functional>
#include <string>

#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/progress.h"
#include "cli/run_evaluation.h"
#include "pliant/evaluation/evaluate_run.h"
#include "pliant/evaluation/report.h"
#include "pliant/evaluation/stir_error.h"

namespace pliant::cli {
namespace {

const Manual kEvaluateManual = {
    "evaluate",
    "compare a run with the truth of its sequence, or with other runs",
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
    "surface, with its own uncertainty), sfm_points.csv or simulation.yaml; without any of these only tracks and "
    "reprojection are evaluated.\n\n"
    "--sfm_path compares the depths with points of structure from motion (a CSV like sfm_points.csv, or a COLMAP "
    "model), after one scale a frame. --other_run compares them with another run of the same recording, at the same "
    "pixels: two runs that were begun at different frames (pliant track --start), or with different seeds, and that "
    "do not agree are not both right. Neither needs a sequence with truth, so --sequence may be left out then.\n\n"
    "--surface compares the dense depths of pliant surface with the depth images of the sequence, beside an "
    "interpolation of the run's points at the same pixels.\n\n"
    "On a simulated sequence the tracks themselves are scored in the images, as TAP-Vid does, and in space, as "
    "TAPVid-3D does: points within 1, 2, 4, 8 and 16 px, Jaccard, occlusion accuracy. --tracks does so for a file of "
    "another program's tracks, in the images, without a run.\n\n"
    "--stir scores points at the end of recordings as the STIR challenge does, with its files: the tracked points, and "
    "the labelled ones of the start (--stir_start) and the end (--stir_end). It needs neither a run nor a sequence; "
    "pliant export --format stir writes a run's. --output_path then has stir.json.\n\n"
    "Leaves, where --output_path is given: evaluation.json (every figure) and evaluation.csv (one row a frame), in "
    "place of those that are there. pliant compare sets several runs side by side.",
    {"pliant evaluate --run run --sequence colon",
     "pliant evaluate --run run --sequence clip.mp4 --camera stereo.yaml --scale none",
     "pliant evaluate --run run --sequence colon --protocol all --scale global --output_path run/evaluation",
     "pliant evaluate --run run --surface surface --sequence colon",
     "pliant evaluate --run run --other_run run_begun_at_20", "pliant evaluate --tracks cotracker.npz --sequence colon",
     "pliant evaluate --stir positions.json --stir_start start.json --stir_end end.json"},
};

// An exit code where the arguments contradict each other (the sentence has been said).
std::optional<int> CheckArguments(const EvaluationRequest& request, const CommandLine& line) {
  if (request.run_path.empty() == request.track_file.path.empty())
    return line.UsageError(request.run_path.empty()
                               ? "--run DIR is missing; see pliant evaluate --help"
                               : "--run and --tracks are evaluated one at a time; give one of them");
  if (request.sequence_path.empty() && request.track_file.IsGiven())
    return line.UsageError("--tracks are compared with the truth of a sequence; give --sequence PATH");
  if (request.sequence_path.empty() && request.other_runs.empty() && request.sfm_path.empty())
    return line.UsageError(
        "--sequence PATH is missing, and so are --other_run and --sfm_path, with which it is not "
        "needed; see pliant evaluate --help");
  return std::nullopt;
}

// Nothing where --stir and its two files are not given; else an exit code.
std::optional<int> EvaluateStirFiles(const StirRequest& stir, const EvaluationRequest& request,
                                     const std::string& output_path, const CommandLine& line) {
  if (stir.tracked_path.empty() && stir.start_path.empty() && stir.end_path.empty()) return std::nullopt;
  if (stir.tracked_path.empty() || stir.start_path.empty() || stir.end_path.empty())
    return line.UsageError("--stir, --stir_start and --stir_end belong together; give all three");
  if (!request.run_path.empty() || !request.sequence_path.empty() || request.track_file.IsGiven())
    return line.UsageError("--stir is scored by itself; leave --run, --tracks and --sequence out");
  const auto error = EvaluateStir(stir);
  if (!error.ok()) return line.Failure(error.status().message());
  if (!output_path.empty())
    if (const Status status = WriteStirError(*error, output_path); !status.ok()) return line.Failure(status.message());
  SayResult(StirTable(*error));
  return kExitOk;
}

void AddStirArguments(CommandLine* line, StirRequest* stir) {
  line->Add("stir", &stir->tracked_path, "FILE", "instead of a run: tracked points in the JSON of the STIR challenge",
            Need::kOptional);
  line->Add("stir_start", &stir->start_path, "FILE", "the labelled points of the start, likewise", Need::kOptional);
  line->Add("stir_end", &stir->end_path, "FILE", "the labelled points of the end, likewise", Need::kOptional);
}

}  // namespace

int EvaluateCommand(std::span<const std::string> args) {
  EvaluationRequest request;
  std::string output_path;
  EvaluationOptions options;
  CommandLine line(kEvaluateManual);
  line.Add("run", &request.run_path, "DIR", "run folder; needed unless --tracks or --stir is given", Need::kOptional,
           Positional::kYes);
  line.AddAlias("tracks", "TrackFile.path", "FILE",
                "instead of a run: a file of point tracks, as pliant track --tracks reads it");
  line.AddAlias("tracks_pixel_origin", "TrackFile.pixel_origin", "center|corner",
                "what (0, 0) is in that file: the center of the first pixel (the default), or its upper left corner");
  line.Add("sequence", &request.sequence_path, "PATH",
           "sequence with truth: a folder, or a video of pairs; needed unless --other_run or --sfm_path is given",
           Need::kOptional);
  line.Add("other_run", &request.other_runs, "DIR", "folder of another run of the same recording", Need::kOptional);
  line.Add(
      "sfm_path", &request.sfm_path, "PATH",
      "points of structure from motion: a CSV, or the folder of a COLMAP model; else sfm_points.csv of the sequence",
      Need::kOptional);
  line.Add("surface", &request.surface_path, "DIR", "surface that pliant surface made of the run: its error too",
           Need::kOptional);
  StirRequest stir;
  AddStirArguments(&line, &stir);
  AddEvaluationArguments(&line, &request.camera_path);
  line.Add("output_path", &output_path, "DIR", "folder for the JSON and CSV files", Need::kOptional);
  if (const auto exit = line.Parse(args)) return *exit;
  OptionTable table;
  options.List(table);
  request.track_file.List(table);
  if (const auto exit = line.Resolve(table)) return *exit;
  if (const auto exit = EvaluateStirFiles(stir, request, output_path, line)) return *exit;
  if (const auto exit = CheckArguments(request, line)) return *exit;

  const auto evaluation = [&] {
    JobBars bars(StopOnSignals());
    return EvaluateRun(request, options, std::ref(bars));
  }();
  if (!evaluation.ok()) return line.Failure(evaluation.status().message());
  if (!output_path.empty())
    if (const Status status = WriteEvaluation(*evaluation, output_path); !status.ok())
      return line.Failure(status.message());
  SayResult(EvaluationTable(*evaluation));
  return kExitOk;
}

}  // namespace pliant::cli
