// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <filesystem>

#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/main_simulation_options.h"
#include "cli/messages.h"
#include "cli/output_folder.h"
#include "cli/run_evaluation.h"
#include "cli/track_progress.h"
#include "pliant/base/text.h"
#include "pliant/evaluation/evaluate_run.h"
#include "pliant/evaluation/report.h"
#include "pliant/pipeline/track.h"
#include "pliant/simulation/write_sequence.h"
#include "pliant/viewer/report.h"

namespace pliant::cli {
namespace {

const Manual kDemoManual = {
    "demo",
    "simulate, track and evaluate a small sequence",
    "Renders a short way through a colon that deforms, tracks it with the default options from the images alone, "
    "compares the result with the truth, and prints the figures and where to look.\n\n"
    "Reads nothing.\n\n"
    "Leaves in --output_path: sequence/ (see pliant simulate --help), run/ (see pliant track --help), evaluation.json, "
    "evaluation.csv, and report.html (see pliant report --help; not in a build without the report page).",
    {"pliant demo", "pliant demo --output_path /tmp/demo --Deformation.amplitude_mm 5"},
    MainSimulationOptions(),
};

SimulationOptions DemoSimulation() {
  SimulationOptions options;
  // A camera that moves faster than the scene deforms: what the method assumes.
  options.trajectory.kind = TrajectoryKind::kSway;
  options.trajectory.sway_period_s = 2.0;
  options.trajectory.frames = 60;
  options.deformation.amplitude_mm = 2.0;
  return options;
}

void Print(const SimulationOptions& simulation, const RunSummary& run, const Evaluation& evaluation,
           const std::filesystem::path& output) {
  const TrackSurvival& tracks = evaluation.survival;
  const auto say = [](const std::string& name, const std::string& text) {
    SayResult(name + std::string(14 - name.size(), ' ') + text);
  };
  say("sequence", std::to_string(simulation.trajectory.frames) + " frames, deforming by " +
                      FormatNumber("%.3g", simulation.deformation.amplitude_mm) + " mm");
  say("run", std::string(EnumName(run.status)) + ": " + run.note);
  say("frames", std::to_string(run.frames_tracked) + " of " + std::to_string(run.frames_read) + " tracked");
  say("points", std::to_string(tracks.first_points) + " in the first tracked frame, " +
                    std::to_string(tracks.last_points) + " in the last, " + std::to_string(tracks.last_alive_of_first) +
                    " in both");
  if (evaluation.surface) {
    const PointSummary& error = evaluation.surface->plain.estimate;
    const PointSummary& null = evaluation.surface->plain.null;
    say("RMSE", FormatNumber("%.2f mm", error.mean_rmse_mm) +
                    FormatNumber("  (one constant depth instead: %.2f mm)", null.mean_rmse_mm));
    say("median error", FormatNumber("%.2f mm", error.pooled_median_mm) +
                            FormatNumber("  (one constant depth instead: %.2f mm)", null.pooled_median_mm));
  }
  if (evaluation.trajectory)
    say("camera ATE", FormatNumber("%.2f mm", evaluation.trajectory->ate_rmse_mm) +
                          FormatNumber("  over a path of %.1f mm", evaluation.trajectory->true_path_length_mm));
  for (const std::string& note : evaluation.notes) say("note", note);
  say("speed", FormatNumber("%.1f frames/s", run.frames_per_second));
  std::vector<std::string> places;
  if (HasReportPage()) places.push_back((output / "report.html").string() + "  (in a browser)");
  for (const char* place : {"sequence/images", "run/map.ply", "run/observations.csv", "evaluation.json"})
    places.push_back((output / place).string());
  for (std::size_t i = 0; i < places.size(); ++i) say(i == 0 ? "look at" : "", places[i]);
}

Status RunDemo(const SimulationOptions& simulation, const std::filesystem::path& output) {
  const std::atomic<bool>& stop = StopOnSignals();
  const std::filesystem::path sequence = output / "sequence";
  {
    Progress progress("simulate", simulation.trajectory.frames);
    if (Status status = WriteSequence(simulation, sequence,
                                      [&](int done, int) {
                                        progress.Update(done, "");
                                        return stop ? SimulationContinue::kStop : SimulationContinue::kYes;
                                      });
        !status.ok())
      return status;
  }
  RunRequest request;
  request.input.image_path = sequence;
  request.output_path = (output / "run").string();
  request.command_line = {"pliant", "demo"};
  request.stop = &stop;
  const Result<RunSummary> run = [&] {
    TrackProgress progress;
    const std::array<TrackObserver*, 1> observers = {&progress};
    return RunTrack(request, MakeTrackOptions(Preset::kDefault), observers);
  }();
  if (!run.ok()) return run.status();
  if (run->status == RunStatus::kInterrupted || run->frames_tracked == 0)
    return {ErrorCode::kInsufficient, run->note + "; see " + request.output_path};
  const Result<OpenedTruth> truth = OpenTruth({.image_path = sequence}, {});
  if (!truth.ok()) return truth.status();
  const Result<Evaluation> evaluation = EvaluateRun(request.output_path, *truth, {});
  if (!evaluation.ok()) return evaluation.status();
  if (Status status = WriteEvaluation(*evaluation, output.string()); !status.ok()) return status;
  if (HasReportPage()) {
    const auto report =
        WriteReportPage({.run_paths = {request.output_path}, .sequence_path = sequence.string(), .camera_path = ""}, {},
                        (output / "report.html").string());
    if (!report.ok()) return report.status();
  }
  Print(simulation, *run, *evaluation, output);
  return Status::Ok();
}

}  // namespace

int DemoCommand(std::span<const std::string> args) {
  std::string output_path = "pliant_demo";
  CommandLine line(kDemoManual);
  line.Add("output_path", &output_path, "DIR", "folder for everything; made where it is not there", Need::kOptional);
  if (const auto exit = line.Parse(args)) return *exit;

  SimulationOptions simulation = DemoSimulation();
  OptionTable table;
  simulation.List(table);
  if (const auto exit = line.Resolve(table)) return *exit;

  if (const auto exit = OutputFolder().Check(line, output_path, OutputFolder::Content::kSequence)) return *exit;
  if (const Status status = RunDemo(simulation, output_path); !status.ok()) {
    SayError(status.message());
    return kExitFailed;
  }
  return kExitOk;
}

}  // namespace pliant::cli
