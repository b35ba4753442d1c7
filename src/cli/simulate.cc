// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <chrono>
#include <cstdio>

#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/main_simulation_options.h"
#include "cli/messages.h"
#include "cli/output_folder.h"
#include "cli/progress.h"
#include "pliant/simulation/write_sequence.h"

namespace pliant::cli {
namespace {

const Manual kSimulateManual = {
    "simulate",
    "render a deforming scene with depth and poses",
    "Renders what a camera with a light beside it sees in a textured scene that deforms, and writes it as a sequence "
    "that pliant track reads and pliant evaluate knows the truth of. The scene is a colon with folds, a smooth tube, "
    "an organ's surface seen from outside, two lobes that move by themselves, a mesh from a file, or a board for "
    "calibration (Scene.kind).\n\n"
    "Reads nothing but the mesh (Scene.mesh_path) and the camera's poses (Trajectory.path) where they are asked for; "
    "their names are relative to the working folder and are written absolute. The same options give the same files, "
    "byte for byte, whatever the number of threads.\n\n"
    "Leaves in --output_path: camera.yaml, images/NNNNNN.png, depth/NNNNNN.png (16-bit, z along the optical axis in "
    "steps of depth_scale mm, 0 = none), groundtruth.txt (TUM, world_from_camera, mm), times.txt and simulation.yaml "
    "(every option).",
    {"pliant simulate --output_path colon --Deformation.amplitude_mm 2.5",
     "pliant simulate --output_path hard --realism endoscope --Deformation.amplitude_mm 2.5",
     "pliant simulate --output_path rigid --Trajectory.frames 60 --Trajectory.kind sway",
     "pliant simulate --output_path liver --Scene.kind lobes --Trajectory.kind loop --Deformation.amplitude_mm 3",
     // NOLINTNEXTLINE(bugprone-suspicious-missing-comma): one example in two literals
     "pliant simulate --output_path ct --Scene.kind mesh --Scene.mesh_path colon.stl --Trajectory.kind file "
     "--Trajectory.path poses.txt",
     // NOLINTNEXTLINE(bugprone-suspicious-missing-comma): one example in two literals
     "pliant simulate --output_path boards --Scene.kind board --Trajectory.kind board --Trajectory.fps 1 "
     "--Trajectory.frames 24",
     "pliant simulate --output_path again --config colon/simulation.yaml"},
    MainSimulationOptions(),
};

}  // namespace

int SimulateCommand(std::span<const std::string> args) {
  OutputFolder output;
  Realism realism = Realism::kClean;
  CommandLine line(kSimulateManual);
  output.AddTo(&line, "folder of the new sequence; made where it is not there", Need::kRequired);
  line.AddChoice(
      "realism", &realism,
      "the defaults of the options: a clean camera, or noise, weak texture, sharpening, compression and lost "
      "frames as in real endoscopic recordings");
  if (const auto exit = line.Parse(args)) return *exit;

  SimulationOptions options = MakeSimulationOptions(realism);
  OptionTable table;
  options.List(table);
  if (const auto exit = line.Resolve(table)) return *exit;
  if (const auto exit = output.Check(line, output.path, OutputFolder::Content::kSequence)) return *exit;

  const std::atomic<bool>& stop = StopOnSignals();
  using Clock = std::chrono::steady_clock;
  const Clock::time_point started = Clock::now();
  Clock::time_point scene_stood = started;
  Result<Simulator> simulator = Simulator::Create(options);
  Status status = simulator.status();
  int frames = 0;
  if (status.ok()) {
    frames = simulator->frame_count();
    for (const std::string& warning : simulator->warnings()) SayWarning(warning);
    Progress progress("simulate", frames);
    status = WriteSequence(*simulator, output.path, [&](int done, int) {
      if (done == 0) scene_stood = Clock::now();
      progress.Update(done, "");
      return stop ? SimulationContinue::kStop : SimulationContinue::kYes;
    });
  }
  if (!status.ok()) return line.Failure(status);
  const double scene_s = std::chrono::duration<double>(scene_stood - started).count();
  const double frames_s = std::chrono::duration<double>(Clock::now() - scene_stood).count();
  char timing[96];
  std::snprintf(timing, sizeof(timing), "scene built in %.1f s, %.1f frames/s", scene_s, frames / frames_s);
  SayResult(std::to_string(frames) + " frames in " + output.path);
  SayNote(timing);
  return kExitOk;
}

}  // namespace pliant::cli
