// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/viewer/report.h"

#include <cstdio>
#include <functional>

#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/frame_list.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/progress.h"
#include "pliant/base/text.h"
#include "pliant/viewer/bundle.h"
#include "pliant/viewer/figure.h"
#include "pliant/viewer/output.h"

namespace pliant::cli {
namespace {

const Manual kReportManual = {
    "report",
    "show runs: a page for the browser, figures, films",
    "Writes one HTML file that holds everything: the images with the tracked points, the scene in 3D with each point's "
    "trail of deformation and the camera's path, both in step with a time line, plots of errors, costs and times, and "
    "tables of figures and options. It opens from disk in any browser, without a network, and can be sent to "
    "someone.\n\n"
    "With --figure it writes a still instead: the images of the chosen frames with their points above, the scene as it "
    "was then below, a row for each run. With --video it writes a film of all frames. With --surface all of them show "
    "the mesh that pliant surface made, in a still and a film colored by --Figure.surface_color. With --bundle it "
    "writes a folder of at most 5 MB to send with a question: options, run.json, frames.csv, poses, calibration and "
    "versions of one run, without names of files, and without images unless --bundle_images adds ten of them.\n\n"
    "Reads --run, one or more: run folders that pliant track or pliant import left, also of runs that were "
    "interrupted or killed, or other systems' results. They are brought into one world by their cameras. Reads the "
    "images, and the truth where there is truth, from --sequence, or from where the first run's run.json says they "
    "are; without them the rest is shown.\n\n"
    "Leaves the file --output_path; a page, a figure or a film that is there is replaced. In pictures the undeformed "
    "map is black, a point's trail of deformation orange, "
    "the camera blue, and the truth green.",
    {"pliant report --run run -o report.html", "pliant report --run ours --run rigid --sequence colon -o both.html",
     "pliant report --run run --figure 10,40,70 -o figure.svg", "pliant report --run run --video -o film.mp4",
     "pliant report --run run --bundle -o bundle",
     "pliant report --run run --surface surface --figure 10 --Figure.surface_color displacement -o figure.pdf"},
};

struct ReportArguments {
  ViewRequest view;
  std::string output_path;
  std::string figure;  // frames with commas; empty: none
  bool video = false;
  bool bundle = false;
  bool bundle_images = false;
  bool overwrite = false;
};

// Nothing, or what is wrong with the command line.
std::string CheckArguments(const ReportArguments& arguments, std::vector<int>* frames_idx) {
  const int outputs = (arguments.figure.empty() ? 0 : 1) + (arguments.video ? 1 : 0) + (arguments.bundle ? 1 : 0);
  if (outputs > 1) return "--figure, --video and --bundle are written one at a time; give one of them";
  if (arguments.bundle_images && !arguments.bundle) return "--bundle_images adds images to a bundle; give --bundle too";
  if (arguments.bundle)
    return arguments.view.run_paths.size() > 1 ? "--bundle is of one run; give one --run" : std::string();
  const auto frames = ParseFrameList("--figure", arguments.figure);
  if (!frames.ok()) return frames.status().message();
  *frames_idx = *frames;
  const ViewOutput output = !arguments.figure.empty() ? ViewOutput::kFigure
                            : arguments.video         ? ViewOutput::kFilm
                                                      : ViewOutput::kPage;
  return CheckEnding(output, arguments.output_path, "--output_path").message();
}

void SayNotes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) SayNote(note);
}

int WritePage(const CommandLine& line, const ReportArguments& arguments, const ReportOptions& options) {
  const auto summary = [&] {
    JobBars bars(StopOnSignals());
    return WriteReportPage(arguments.view, options, arguments.output_path, std::ref(bars));
  }();
  if (!summary.ok()) return line.Failure(summary.status().message());
  SayNotes(summary->notes);
  char text[128];
  std::snprintf(text, sizeof text, "%d frames, %lld observations, %zu images, %.1f MB in ", summary->frames,
                static_cast<long long>(summary->observations), summary->images, summary->megabytes);
  SayResult(text + arguments.output_path);
  return kExitOk;
}

int WriteRunBundle(const CommandLine& line, const ReportArguments& arguments) {
  const BundleRequest request{.run_path = arguments.view.run_paths.front(),
                              .output_path = arguments.output_path,
                              .sequence_path = arguments.view.sequence_path,
                              .camera_path = arguments.view.camera_path,
                              .images = arguments.bundle_images ? BundledImages::kSome : BundledImages::kNone,
                              .program_version = ProgramVersion(),
                              .replaces_bundle = arguments.overwrite};
  const auto summary =
      WithBars(StopOnSignals(), [&](const JobProgress& progress) { return WriteBundle(request, progress); });
  if (!summary.ok()) return line.Failure(summary.status());
  SayNotes(summary->notes);
  SayResult(std::to_string(summary->files.size()) + " files, " + Digits(summary->megabytes, 1) + " MB in " +
            arguments.output_path + "; look through them before you send them");
  return kExitOk;
}

Result<std::vector<std::string>> WriteFilmWithProgress(const ReportArguments& arguments, const FigureOptions& options) {
  const std::atomic<bool>& stop = StopOnSignals();
  Progress progress("film");
  bool stopped = false;
  auto notes = WriteFilm(arguments.view, options, arguments.output_path, [&](int done, int frames) {
    progress.Update(done, "of " + std::to_string(frames));
    stopped = stop && done < frames;
    return !stopped;
  });
  if (notes.ok() && stopped)
    return Status(ErrorCode::kInsufficient, "stopped on request; the film up to there is in " + arguments.output_path);
  return notes;
}

Result<std::vector<std::string>> WriteFigureWithProgress(const ReportArguments& arguments, const FigureOptions& options,
                                                         const std::vector<int>& frames_idx) {
  return WithBars(StopOnSignals(), [&](const JobProgress& progress) {
    return WriteFigure(arguments.view, options, frames_idx, arguments.output_path, progress);
  });
}

}  // namespace

int ReportCommand(std::span<const std::string> args) {
  ReportArguments arguments;
  CommandLine line(kReportManual);
  line.Add("run", &arguments.view.run_paths, "DIR", "run folder", Need::kRequired, Positional::kYes);
  line.Add("sequence", &arguments.view.sequence_path, "PATH",
           "the images, with truth where there is; without it those that the first run's run.json names",
           Need::kOptional);
  line.Add("camera", &arguments.view.camera_path, "FILE",
           "calibration of the sequence; not needed where it has its own, or for the run's images", Need::kOptional);
  line.Add("surface", &arguments.view.surface_paths, "DIR",
           "a surface folder of the run (pliant surface), whose mesh is shown", Need::kOptional);
  line.Add("output_path", &arguments.output_path, "FILE",
           "what is written: .html; .png, .svg or .pdf; .mp4; the folder of a bundle", Need::kRequired);
  line.Add("figure", &arguments.figure, "FRAMES", "a still of these frames: their numbers, with commas",
           Need::kOptional);
  line.AddFlag("video", &arguments.video, "a film of all frames");
  line.AddFlag("bundle", &arguments.bundle, "a folder to send with a question, without images");
  line.AddFlag("bundle_images", &arguments.bundle_images, "add ten images of the recording to it");
  line.AddFlag("overwrite", &arguments.overwrite,
               "replace a bundle that is there; other files are replaced without it");
  if (const auto exit = line.Parse(args)) return *exit;
  ReportOptions report_options;
  FigureOptions figure_options;
  OptionTable table;
  report_options.List(table);
  figure_options.List(table);
  if (const auto exit = line.Resolve(table)) return *exit;
  figure_options.view = report_options.view;
  std::vector<int> frames_idx;
  if (const std::string wrong = CheckArguments(arguments, &frames_idx); !wrong.empty()) return line.UsageError(wrong);

  if (arguments.bundle) return WriteRunBundle(line, arguments);
  if (arguments.figure.empty() && !arguments.video) return WritePage(line, arguments, report_options);
  const auto notes = arguments.video ? WriteFilmWithProgress(arguments, figure_options)
                                     : WriteFigureWithProgress(arguments, figure_options, frames_idx);
  if (!notes.ok()) return line.Failure(notes.status().message());
  SayNotes(*notes);
  SayResult(arguments.output_path);
  return kExitOk;
}

}  // namespace pliant::cli
