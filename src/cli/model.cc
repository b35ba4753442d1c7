// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/colmap/model.h"

#include <algorithm>
#include <functional>

#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/progress.h"
#include "pliant/base/text.h"
#include "pliant/colmap/check.h"

namespace pliant::cli {
namespace {

const Manual kCheckManual = {
    "model check",
    "say what is wrong with a COLMAP model",
    "Reads a folder with cameras, images and points3D, .bin or .txt (where both are there the binary ones, as COLMAP "
    "does), since COLMAP 3.12 also rigs and frames. Prints how many of each there are, and then a line for everything "
    "that is wrong: how many have it, and the first of them.\n\n"
    "An error is what COLMAP or another reader fails on: tracks and keypoints that refer to nothing or not to each "
    "other, values that are not numbers, images without their camera. A warning is what is allowed but hardly "
    "intended: points "
    "seen in one image alone, or behind a camera. COLMAP's model_analyzer finds none of it.\n\n"
    "Ends with 1 if there is an error, or the model cannot be read.",
    {"pliant model check run/sparse", "pliant model check reconstruction/sparse/0"},
};

const Manual kModelConvertManual = {
    "model convert",
    "write a COLMAP model as text or binary",
    "Reads a folder with cameras, images and points3D, and writes them into another, as COLMAP itself does: a model "
    "that COLMAP wrote comes back byte for byte. All files appear at the end, or none. --rigs writes rigs and frames "
    "too, where there are some; without it the model is one that every version of COLMAP reads.",
    {"pliant model convert sparse/0 --output_path text --format text"},
};

std::string Counts(const colmap::Model& model) {
  std::size_t observations = 0;
  for (const colmap::Point3D& point : model.points3D) observations += point.track.size();
  std::string text = std::to_string(model.cameras.size()) + " cameras, " + std::to_string(model.images.size()) +
                     " images, " + std::to_string(model.points3D.size()) + " points, " + std::to_string(observations) +
                     " observations";
  if (!model.rigs.empty() || !model.frames.empty())
    text += ", " + std::to_string(model.rigs.size()) + " rigs, " + std::to_string(model.frames.size()) + " frames";
  return text;
}

// The first image whose name has a blank; empty: there is none.
std::string NameThatColmapCuts(const colmap::Model& model) {
  const auto found = std::ranges::find_if(
      model.images, [](const colmap::Image& image) { return image.name.find(' ') != std::string::npos; });
  return found == model.images.end() ? "" : found->name;
}

int CheckCommand(std::span<const std::string> args) {
  std::string path;
  CommandLine line(kCheckManual);
  line.Add("input_path", &path, "DIR", "folder of the model", Need::kRequired, Positional::kYes);
  line.Renamed("path", "input_path");
  if (const auto exit = line.Parse(args)) return *exit;
  OptionTable no_options;
  if (const auto exit = line.Resolve(no_options)) return *exit;

  const auto model = colmap::ReadModel(path);
  if (!model.ok()) return line.Failure(model.status().message());
  SayResult(Counts(*model));
  const std::vector<colmap::Finding> findings = colmap::CheckModel(*model);
  for (const colmap::Finding& finding : findings)
    SayResult((finding.severity == colmap::Severity::kError ? "error: " : "warning: ") + std::string(finding.what) +
              ": " + std::to_string(finding.count) + ", the first: " + Printable(finding.example));
  const auto format = colmap::FindModel(path);
  if (format.ok() && *format == colmap::Format::kBoth)
    SayNote("there are text files too; COLMAP reads the binary ones");
  if (findings.empty()) SayResult("nothing is wrong");
  return colmap::IsValid(findings) ? kExitOk : kExitFailed;
}

int ConvertCommand(std::span<const std::string> args) {
  std::string input_path;
  std::string output_path;
  colmap::Format format = colmap::Format::kBinary;
  bool with_rigs = false;
  CommandLine line(kModelConvertManual);
  line.Add("input_path", &input_path, "DIR", "folder of the model", Need::kRequired, Positional::kYes);
  line.Add("output_path", &output_path, "DIR", "folder to write, made if need be", Need::kRequired);
  line.AddChoice("format", &format, "what to write");
  line.AddFlag("rigs", &with_rigs, "write rigs and frames too (COLMAP 3.12 and later)");
  if (const auto exit = line.Parse(args)) return *exit;
  OptionTable no_options;
  if (const auto exit = line.Resolve(no_options)) return *exit;

  std::string cut_name;
  const Status status = [&] {
    JobBars bars(StopOnSignals());
    const auto model = colmap::ReadModel(input_path, colmap::Observations::kRead, std::ref(bars));
    if (!model.ok()) return model.status();
    if (format != colmap::Format::kBinary) cut_name = NameThatColmapCuts(*model);
    const colmap::Rigs rigs = with_rigs && !model->rigs.empty() ? colmap::Rigs::kWritten : colmap::Rigs::kLeftOut;
    return colmap::WriteModel(output_path, *model, format, rigs, std::ref(bars));
  }();
  if (!status.ok()) return line.Failure(status.message());
  if (!cut_name.empty())
    SayWarning("COLMAP reads a name of an image in text up to its first blank, so it will not find " +
               Quoted(cut_name) + "; use --format binary for it, or rename the images");
  return kExitOk;
}

}  // namespace

int ModelCommand(std::span<const std::string> args) {
  constexpr Verb kVerbs[] = {{"check", "DIR", CheckCommand}, {"convert", "DIR --output_path DIR", ConvertCommand}};
  return RunVerb("model", kVerbs, args);
}

}  // namespace pliant::cli
