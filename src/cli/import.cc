// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/exchange/import.h"

#include <functional>

#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/output_folder.h"
#include "cli/progress.h"

namespace pliant::cli {
namespace {

const Manual kImportManual = {
    "import",
    "make a run, or a sequence's truth, of another program's result",
    "Reads --input_path, by --format:\n\n"
    "colmap: a folder with COLMAP's cameras, images and points3D, .bin or .txt. An image is the frame of the same file "
    "name, or the same stem. The camera is the model's.\n\n"
    "result: a folder with trajectory.txt (TUM) and observations.csv, which a page of docs/formats.md describes.\n\n"
    "tum, kitti, euroc: a file with a camera path. Poses belong to the nearest frame in time, KITTI's to the frame of "
    "their line, of which there has to be one a frame; they are world_from_camera, the CAMERA's (EuRoC's own ground "
    "truth is the IMU's).\n\n"
    "Reads --sequence, the images that it was made of: their names, times and, of a camera path, the calibration.\n\n"
    "Leaves in --output_path, with --as run, a run folder that evaluate, compare and export read like one of pliant "
    "track; frames without a pose are not tracked, and ssim is 0 where it is not known. With --as truth, "
    "groundtruth.txt and, where there is none, camera.yaml: what a native sequence has beside its images.",
    {"pliant import --input_path reconstruction/sparse/0 --sequence colon --output_path rigid",
     "pliant import --input_path sparse/0 --sequence photos --as truth --output_path photos",
     "pliant import --format tum --input_path CameraTrajectory.txt --sequence colon --Import.unit_mm 1000 "
     "--output_path orb"},
};

}  // namespace

int ImportCommand(std::span<const std::string> args) {
  ImportRequest request;
  ImportOptions options;
  OutputFolder output;
  CommandLine line(kImportManual);
  line.Add("input_path", &request.input_path, "PATH", "what to import", Need::kRequired, Positional::kYes);
  line.AddChoice("format", &request.format, "what it is");
  line.Add("sequence", &request.sequence_path, "PATH", "the images that it was made of", Need::kRequired);
  line.Add("camera", &request.camera_path, "FILE",
           "calibration of images that have no camera.yaml; without it the one of a COLMAP model", Need::kOptional);
  line.AddChoice("as", &request.as, "what to make of it");
  output.AddTo(&line, "folder to write, made if need be", Need::kRequired);
  if (const auto exit = line.Parse(args)) return *exit;
  OptionTable table;
  options.List(table);
  if (const auto exit = line.Resolve(table)) return *exit;

  if (request.as == ImportAs::kRun)
    if (const auto exit = output.Check(line, output.path, OutputFolder::Content::kRun)) return *exit;
  request.output_path = output.path;
  request.command_line = line.Words(args);
  const auto summary = [&] {
    JobBars bars(StopOnSignals());
    return Import(request, options, std::ref(bars));
  }();
  if (!summary.ok()) return line.Failure(summary.status().message());
  for (const std::string& note : summary->notes) SayNote(note);
  SayResult(std::to_string(summary->frames) + " of " + std::to_string(summary->sequence_frames) + " frames, " +
            std::to_string(summary->points) + " points, " + std::to_string(summary->observations) +
            " observations in " + request.output_path);
  return kExitOk;
}

}  // namespace pliant::cli
