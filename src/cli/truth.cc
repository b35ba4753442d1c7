// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>

#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/progress.h"
#include "pliant/simulation/material_truth.h"
#include "pliant/simulation/open_simulation.h"

namespace pliant::cli {
namespace {

const Manual kTruthManual = {
    "truth",
    "follow the material that pixels of a simulated sequence show",
    "Says which point of the wall each of the given pixels shows, and where that point is in every frame of the "
    "sequence: its position in the world, the pixel where it is seen, and whether it is visible.\n\n"
    "Reads --sequence: a folder that pliant simulate left. Its simulation.yaml builds the scene again; nothing is "
    "rendered. Reads --points: a CSV file with a header that names frame, u_px and v_px (the first pixel's center is "
    "0, "
    "0; other columns are passed over). Instead of a file, --grid_px N takes every Nth pixel each way of --frame.\n\n"
    "Leaves --output_path: a CSV file with one row a point and frame, point,frame,u_px,v_px,x,y,z,depth_mm,visibility. "
    "Points are counted from 0 in their order; one whose pixel shows no wall has no rows. x, y, z in the world, mm; "
    "u_px and v_px are empty where the point does not project; visibility is visible, occluded or outside.",
    {"pliant truth --sequence colon --points points.csv --output_path paths.csv",
     "pliant truth --sequence colon --grid_px 20 --frame 0 --output_path paths.csv"},
};

struct Arguments {
  std::string sequence_path;
  std::string points_path;
  std::string output_path;
  int grid_px = 0;
  int frame_idx = 0;
};

Status Follow(const Arguments& arguments) {
  Result<std::vector<FramePixel>> starts(std::vector<FramePixel>{});
  if (!arguments.points_path.empty()) starts = ReadFramePixels(arguments.points_path);
  if (!starts.ok()) return starts.status();
  Result<Simulator> simulator = OpenSimulation(arguments.sequence_path);
  if (!simulator.ok()) return simulator.status();
  if (arguments.grid_px > 0) starts = PixelGrid(simulator->camera(), arguments.frame_idx, arguments.grid_px);
  const std::atomic<bool>& stop = StopOnSignals();
  Result<std::vector<MaterialPath>> paths(std::vector<MaterialPath>{});
  {
    Progress progress("truth", simulator->frame_count());
    paths = FollowMaterial(*simulator, *starts, [&](int done, int) {
      progress.Update(done, "");
      return stop ? SimulationContinue::kStop : SimulationContinue::kYes;
    });
  }
  if (!paths.ok()) return paths.status();
  if (Status status = WriteMaterialPaths(arguments.output_path, *paths); !status.ok()) return status;
  const auto found = std::ranges::count_if(*paths, [](const MaterialPath& path) { return path.point.has_value(); });
  SayResult(std::to_string(found) + " of " + std::to_string(paths->size()) + " points in " +
            std::to_string(simulator->frame_count()) + " frames in " + arguments.output_path);
  return Status::Ok();
}

}  // namespace

int TruthCommand(std::span<const std::string> args) {
  Arguments arguments;
  CommandLine line(kTruthManual);
  line.Add("sequence", &arguments.sequence_path, "DIR", "folder of a simulated sequence", Need::kRequired,
           Positional::kYes);
  line.Add("points", &arguments.points_path, "FILE", "CSV file of the pixels to follow", Need::kOptional);
  line.Add("grid_px", &arguments.grid_px, "follow every Nth pixel each way instead; 0: none", 0, 10000);
  line.Add("frame", &arguments.frame_idx, "frame of the grid", 0, 1000000);
  line.Add("output_path", &arguments.output_path, "FILE", "CSV file to write", Need::kRequired);
  if (const auto exit = line.Parse(args)) return *exit;
  OptionTable no_options;
  if (const auto exit = line.Resolve(no_options)) return *exit;
  if (arguments.points_path.empty() == (arguments.grid_px == 0))
    return line.UsageError("give either --points FILE or --grid_px N");
  const Status status = Follow(arguments);
  return status.ok() ? kExitOk : line.Failure(status);
}

}  // namespace pliant::cli
