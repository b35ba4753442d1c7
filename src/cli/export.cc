// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/exchange/export.h"

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/progress.h"
#include "cli/sequence_arguments.h"

namespace pliant::cli {
namespace {

std::string ManualText() {
  std::string text =
      "Reads --run: a run folder that pliant track left, also one that was interrupted or killed. Then the camera and "
      "the images' names are taken from the sequence that it was made of, or from --sequence. The formats nerfstudio "
      "and "
      "endonerf hold the images, which come from there too, and take --surface, a folder that pliant surface left.\n\n"
      "Leaves in --output_path, by --format:";
  for (const ExportFormat& format : ExportFormats())
    text += "\n\n" + std::string(format.name) + ": " + std::string(format.what);
  return text;
}

std::vector<std::string_view> FormatNames() {
  std::vector<std::string_view> names;
  for (const ExportFormat& format : ExportFormats()) names.push_back(format.name);
  return names;
}

}  // namespace

int ExportCommand(std::span<const std::string> args) {
  ExportRequest request;
  ExportOptions options;
  const std::string text = ManualText();
  CommandLine line({"export",
                    "write a run in other programs' formats",
                    text,
                    {"pliant export --run run --format spacetime --output_path spacetime",
                     "pliant export --run run --format canonical --output_path text --Export.files text",
                     "pliant export --run run --format database --output_path colmap",
                     "pliant export --run run --format nerfstudio --surface surface --output_path splats"}});
  line.Add("run", &request.run_path, "DIR", "run folder", Need::kRequired, Positional::kYes);
  line.AddChoice("format", &request.format, FormatNames(), "what to write");
  line.Add("output_path", &request.output_path, "DIR", "folder to write, made if need be", Need::kRequired);
  line.Add("sequence", &request.sequence_path, "PATH",
           "the run's images, where they are needed; without it those that its run.json names", Need::kOptional);
  AddCameraOfRun(&line, &request.camera_path);
  AddMasksOfRun(&line, &request.mask_path);
  line.Add("surface", &request.surface_path, "DIR", "depths of the frames; frames without one are left out",
           Need::kOptional);
  if (const auto exit = line.Parse(args)) return *exit;
  OptionTable table;
  options.List(table);
  if (const auto exit = line.Resolve(table)) return *exit;

  const auto summary = [&] {
    JobBars bars(StopOnSignals());
    return ExportRun(request, options, std::ref(bars));
  }();
  if (!summary.ok()) return line.Failure(summary.status());
  for (const std::string& note : summary->notes) SayNote(note);
  SayResult(std::to_string(summary->frames) + " frames, " + std::to_string(summary->points) + " points, " +
            std::to_string(summary->observations) + " observations in " + request.output_path);
  return kExitOk;
}

}  // namespace pliant::cli
