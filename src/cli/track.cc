// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/pipeline/track.h"

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/output_folder.h"
#include "cli/run_refinement.h"
#include "cli/sequence_arguments.h"
#include "cli/track_progress.h"
#include "pliant/base/text.h"
#include "pliant/io/checkpoint.h"
#include "pliant/io/run_trust.h"
#include "pliant/viewer/live_view.h"
#include "pliant/viewer/view.h"

namespace pliant::cli {
namespace {

const Manual kTrackManual = {
    "track",
    "camera pose and the motion of every point, from a folder of images or a video",
    "Follows points through the images of one moving, calibrated camera in a scene that deforms, and estimates for "
    "every frame where the camera is and where every point is. A first map comes from the first frames in which the "
    "camera has moved enough (Init.method); it has no scale of its own and is scaled once, so that its median depth is "
    "the configured nominal depth.\n\n"
    "Reads --image_path: a native sequence (a folder with images/ and camera.yaml), any folder of png, jpg, bmp or tif "
    "images in natural order, a video file, or live: device:0 (a camera), an address (rtsp://, http://, ...) or - "
    "(standard input). Reads --camera: camera.yaml, COLMAP's cameras.txt or cameras.bin, or an "
    "OpenCV calibration in YAML or XML; without it, camera.yaml in the folder or beside the video. Pixel (0, 0) is the "
    "center of the first pixel.\n\n"
    "Leaves in --output_path: config.yaml (every option as resolved), run.json (what ran and how it ended), "
    "trajectory.txt (TUM, world_from_camera), frames.csv (one row a frame), observations.csv (one row a point and "
    "frame), map.ply (the undeformed map) and sparse/ (a COLMAP model). Rows are on disk as frames are done: a run "
    "that is lost, interrupted or killed keeps what it had. When too few points are left the "
    "camera is searched for in every frame, and after a while another map is begun (map_1.ply, sparse/0 and sparse/1; "
    "frames.csv says which one a frame belongs to). A run that ends while the camera is lost has the status "
    "`lost` in run.json; that is a result, not a failure: the exit code is 0.",
    {"pliant track clip.mp4 --camera camera.yaml --output_path run",
     "pliant track device:0 --camera camera.yaml --output_path run --live",
     "pliant track --image_path seq --output_path run --tracks cotracker.npz",
     "pliant track --image_path seq --output_path run --preset paper --start 100 --end 400",
     "pliant track hours.mp4 --camera camera.yaml --output_path run --resume"},
    {"General.seed", "General.threads", "Masks.highlights", "Masks.border", "Corners.max_corners", "Init.method",
     "Init.provisional", "Init.nominal_depth_mm", "Tracking.camera_motion", "Tracking.submaps", "Growth.grow",
     "Refine.model"},
};

struct TrackArguments {
  SequenceArguments input;
  OutputFolder output;
  Preset preset = Preset::kDefault;
  bool live = false;
  bool live_keep = false;
  bool refine = false;
  bool resume = false;
};

void AddArguments(TrackArguments* arguments, CommandLine* line) {
  arguments->input.AddTo(line);
  arguments->output.AddTo(line,
                          "run folder; made where it is not there (default: the images' name with date and time, here)",
                          Need::kOptional);
  line->AddChoice("preset", &arguments->preset,
                  "the defaults of the options: ours, or every choice and constant as published in the paper");
  line->AddAlias("tracks", "TrackFile.path", "FILE",
                 "follow the point tracks of another program instead of our own: CSV, .npz, .npy or a COLMAP database "
                 "(docs/tracks.md)");
  line->AddAlias("tracks_pixel_origin", "TrackFile.pixel_origin", "center|corner",
                 "what (0, 0) is in that file: the center of the first pixel (the default; CoTracker, OpenCV), or its "
                 "upper left corner (TAP-Vid, TAPIR)");
  line->AddAlias(
      "depth_prior", "DepthPrior.path", "DIR",
      "depth images of another program, such as a network's, a file an image: a weak measurement whose scale "
      "and shift are not known (docs/your_own_video.md)");
  line->AddFlag("resume", &arguments->resume,
                "go on with the run in --output_path that was stopped or killed, from its last checkpoint (option "
                "General.checkpoint_frames); the other arguments are given again as they were");
  line->AddFlag("live", &arguments->live,
                "serve a view of the run to a browser on this machine while it runs (options Live)");
  line->AddFlag("live_keep", &arguments->live_keep,
                "with --live: go on serving the view after the run has ended, until Ctrl-C");
  line->AddFlag("refine", &arguments->refine,
                "then refine the run (pliant refine, options Refine), into a folder with _refined behind its name");
}

// A folder in the working folder, for a run that was not named: clip_20260131_174501.
std::string DatedFolder(const std::string& image_path) {
  const std::filesystem::path path = std::filesystem::path(image_path).lexically_normal();
  const std::string name = IsLiveSource(image_path) ? "live"
                           : path.has_filename()    ? path.stem().string()
                                                    : path.parent_path().filename().string();
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  std::array<char, 32> date;
  std::strftime(date.data(), date.size(), "%Y%m%d_%H%M%S", &local);
  return (name.empty() || name == "." || name == ".." ? "run" : name) + "_" + date.data();
}

int Report(const RunSummary& summary, const TrackArguments& arguments) {
  if (const Status end = EndOf(summary, arguments.output.path); !end.ok()) {
    SayError(end.message());
    return kExitFailed;
  }
  const std::string rate =  // with --General.timings none it is not known
      summary.frames_per_second > 0 ? ", " + Digits(summary.frames_per_second, 1) + " frames/s" : "";
  const std::string maps = summary.submaps > 1 ? " in " + std::to_string(summary.submaps) + " maps" : "";
  SayResult(std::string(EnumName(summary.status)) + ": " + summary.note + "\n" +
            std::to_string(summary.frames_tracked) + " of " + std::to_string(summary.frames_read) + " frames tracked" +
            maps + ", " + std::to_string(summary.points) + " points" + rate + "\n" + arguments.output.path);
  if (summary.stream)
    SayResult("  " + std::to_string(summary.stream->skipped) + " of " + std::to_string(summary.stream->received) +
              " images that came were skipped; the others are in " + RecordingOf(arguments.output.path).string());
  if (summary.stream && summary.stream->damaged > 0)
    SayResult("  " + std::to_string(summary.stream->damaged) +
              " images that came were cut off or could not be decoded");
  for (const auto& [topic, sentence] : TrustIn(summary)) SayResult("  " + topic + ": " + sentence);
  return kExitOk;
}

std::string RefinedFolder(const std::string& run_path) {
  return std::filesystem::path(run_path + "/").parent_path().string() + "_refined";
}

// Names the output folder where it was not named. An exit code where it, or what else is written, is not to be
// replaced; what a resumed run was refined to is.
std::optional<int> ChooseOutput(const CommandLine& line, TrackArguments* arguments) {
  OutputFolder& output = arguments->output;
  if (arguments->resume && output.path.empty())
    return line.UsageError("--resume needs the folder of the run that is gone on with; name it with --output_path");
  if (arguments->resume && output.overwrite)
    return line.UsageError("--resume goes on with a run and --overwrite begins a new one; give one of them");
  if (arguments->resume && IsLiveSource(arguments->input.path))
    return line.UsageError(
        "the images of a live source do not come again: such a run cannot be resumed; track its "
        "recording, " +
        Quoted(RecordingOf(output.path).string()));
  if (output.path.empty()) output.path = DatedFolder(arguments->input.path);
  if (!arguments->resume)
    if (const auto exit = output.Check(line, output.path, OutputFolder::Content::kRun)) return exit;
  if (arguments->refine && !arguments->resume)
    if (const auto exit = output.Check(line, RefinedFolder(output.path), OutputFolder::Content::kRun)) return exit;
  if (IsLiveSource(arguments->input.path))
    return output.Check(line, RecordingOf(output.path).string(), OutputFolder::Content::kSequence);
  return std::nullopt;
}

int Refine(const RunRequest& request, const TrackArguments& arguments, const RefineOptions& options) {
  RefineRequest refinement;
  refinement.run_path = arguments.output.path;
  refinement.output_path = RefinedFolder(arguments.output.path);
  refinement.command_line = request.command_line;
  refinement.stop = request.stop;
  return RefineAndSay(refinement, options);
}

// Until the next Ctrl-C; one that has ended a run on a live source is over. Any other signal, and one that has ended a
// run on files, ends the program.
void KeepServing(bool is_live_source, LiveView* live) {
  std::atomic<bool>& stop = StopOnSignals();
  if (stop && !(is_live_source && LastSignal() == SIGINT)) return;
  live->KeepRun();
  stop = false;
  SayNote("the live view stays at " + live->Url() + "; Ctrl-C ends it");
  while (!stop) std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

}  // namespace

int TrackCommand(std::span<const std::string> args) {
  TrackArguments arguments;
  CommandLine line(kTrackManual);
  AddArguments(&arguments, &line);
  if (const auto exit = line.Parse(args)) return *exit;

  if (const auto exit = arguments.input.Check(line)) return *exit;

  TrackOptions options = MakeTrackOptions(arguments.preset);
  OptionTable table;
  options.List(table);
  LiveOptions live_options;
  live_options.List(table);
  RefineOptions refine_options;
  refine_options.List(table);
  if (const auto exit = line.Resolve(table)) return *exit;
  if (const Status status = CheckTrackOptions(options); !status.ok()) return line.UsageError(status.message());
  if (arguments.live_keep && !arguments.live) return line.UsageError("--live_keep is for --live; give that as well");

  if (const auto exit = ChooseOutput(line, &arguments)) return *exit;
  RunRequest request;
  request.input = arguments.input.Request();
  request.output_path = arguments.output.path;
  request.replaces_run = arguments.output.overwrite || arguments.resume;
  request.resume = arguments.resume;
  request.command_line = line.Words(args);
  request.stop = &StopOnSignals();

  std::unique_ptr<LiveView> live;
  if (arguments.live) {
    auto started = LiveView::Start({RunName(arguments.output.path), options.tracker.init.IsMetric()}, live_options);
    if (!started.ok()) return line.Failure(started.status().message());
    live = *std::move(started);
    SayNote("live view: " + live->Url());
  }
  const bool had_ended = arguments.resume && EndedRun(request.output_path).has_value();
  const Result<RunSummary> summary = [&] {
    TrackProgress progress;
    std::vector<TrackObserver*> observers = {&progress};
    if (live) observers.push_back(live.get());
    return RunTrack(request, options, observers);
  }();
  if (!summary.ok()) {
    SayError(summary.status().message());
    return kExitFailed;
  }
  if (!arguments.live_keep) live.reset();
  int exit_code = Report(*summary, arguments);
  if (had_ended && live) SayNote("the run had ended before: the live view has nothing to show");
  if (arguments.refine && summary->frames_tracked > 0 && exit_code == kExitOk &&
      !(had_ended && EndedRun(RefinedFolder(request.output_path)))) {
    // Ctrl-C has ended the source; other signals end the program.
    if (IsLiveSource(arguments.input.path) && LastSignal() == SIGINT) StopOnSignals() = false;
    exit_code = Refine(request, arguments, refine_options);
  }
  if (live && !had_ended) KeepServing(IsLiveSource(arguments.input.path), live.get());
  return exit_code;
}

}  // namespace pliant::cli
