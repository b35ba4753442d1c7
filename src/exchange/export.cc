// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/exchange/export.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "exchange/exports.h"
#include "pliant/base/files.h"
#include "pliant/base/staged_folder.h"
#include "pliant/base/text.h"
#include "pliant/io/run_writer.h"
#include "pliant/io/trajectory.h"

namespace pliant {
namespace {

using Needs = ExportFormat::Needs;

constexpr std::array kFormats = {
    ExportFormat{"canonical",
                 "a COLMAP model with one point a track at its undeformed position, all images, their keypoints and "
                 "tracks. The scene moved, so it is not consistent with bundle adjustment.",
                 ExportColmapCanonical},
    ExportFormat{
        "spacetime",
        "a COLMAP model with one point a track and frame, colored by time (early is dark, late is yellow); its "
        "id is frame * 1000000 + track. COLMAP's viewer hides points with short tracks: set its minimum track "
        "length to 1.",
        ExportColmapSpacetime},
    ExportFormat{"frames",
                 "a COLMAP model a frame, in folders 000000, 000001, ..., with the points where they were then.",
                 ExportColmapFrames},
    ExportFormat{"ply",
                 "a file a frame, with color, track id and the displacement dx, dy, dz from the undeformed position.",
                 ExportPly},
    ExportFormat{"trajectories",
                 "trajectories.ply, every point in every frame, those of a track joined by edges, colored by time.",
                 ExportTrajectories},
    ExportFormat{"tum", "trajectory.txt, the camera's path, which evo reads.", ExportTum},
    ExportFormat{"colmap4d", "spacetime with times.bin, points_t.bin and time_meta.json (colmap4d 1.0).",
                 ExportColmap4d},
    ExportFormat{"database",
                 "database.db with tracks as keypoints and verified matches, from which COLMAP's mapper, "
                 "point_triangulator and bundle_adjuster reconstruct; made by the COLMAP that is installed.",
                 ExportDatabase},
    ExportFormat{"tracks_csv",
                 "tracks.csv, the points' pixels alone: frame,track_id,u_px,v_px, which pliant track --tracks reads.",
                 ExportTracksCsv},
    ExportFormat{"tracks_npz",
                 "tracks.npz, the same as NumPy's arrays tracks (frames, points, 2), visibility (frames, points) and "
                 "track_id (points), over all frames of the images.",
                 ExportTracksNpz},
    ExportFormat{"stir",
                 "positions.json and, of runs in millimeters, positions3d.json: where the points of the file "
                 "--Export.start_points, or else the run's own, are in its last frame, as the STIR challenge has it.",
                 ExportStir},
    ExportFormat{"nerfstudio",
                 "transforms.json with the images, masks and sparse_pc.ply that it names, and of --surface the depths. "
                 "The poses are in the file's `unit` of map units, so that a step of the depth images is 0.001, which "
                 "nerfstudio expects.",
                 ExportNerfstudio, Needs::kRunAndImages},
    ExportFormat{
        "endonerf",
        "poses_bounds.npy, images/, masks/ (255 = not to be learned from) and of --surface depth/, as EndoNeRF "
        "and programs that follow it read them. The images are those of a pinhole camera with its principal "
        "point in the middle (pinhole.yaml). A step of the depth images is the unit of the poses.",
        ExportEndoNerf, Needs::kRunAndImages},
};

Result<const ExportFormat*> FindFormat(const std::string& name) {
  const auto format = std::ranges::find(kFormats, name, &ExportFormat::name);
  if (format != kFormats.end()) return &*format;
  return Status(ErrorCode::kInvalidArgument, "there is no export format " + Quoted(name) + "; there are " +
                                                 CommaSeparated(kFormats, &ExportFormat::name));
}

Status MakeFolder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (!error) return Status::Ok();
  return {ErrorCode::kUnwritable, "cannot make the folder " + Quoted(path) + ": " + error.message()};
}

// What only formats with images take must not be given to others.
Status CheckNeeds(const ExportFormat& format, const ExportRequest& request) {
  if (format.needs == Needs::kRunAndImages || (request.surface_path.empty() && request.mask_path.empty()))
    return Status::Ok();
  std::string names;
  for (const ExportFormat& known : kFormats)
    if (known.needs == Needs::kRunAndImages) names += (names.empty() ? "" : " and ") + std::string(known.name);
  return {ErrorCode::kInvalidArgument, std::string(request.surface_path.empty() ? "--mask_path" : "--surface") +
                                           " is for the formats " + names + "; the format " + request.format +
                                           " has no images"};
}

// A format's files would replace some of a run's, such as trajectory.txt, or stand between them.
Status CheckOutput(const std::string& path) {
  if (!HoldsRun(path)) return Status::Ok();
  return {ErrorCode::kInvalidArgument, Quoted(path) + " holds a run; give another --output_path"};
}

}  // namespace

std::span<const ExportFormat> ExportFormats() { return kFormats; }

void ExportOptions::List(OptionTable& table) {
  table.BeginGroup("Export", "what is exported of a run");
  table.AddChoice("files", &files, "of COLMAP's models");
  table.Add("stride", &stride, "frames", "every Nth tracked frame", 1, 100000);
  table.Add("min_matches", &min_matches, "-", "database: images that share fewer tracks are not matched", 1, 1000000);
  table.AddChoice("mask_unknown_depth", &mask_unknown_depth,
                  "endonerf, with a surface: pixels without a depth are not to be learned from");
  table.Add("start_points", &start_points, "file",
            "stir: JSON with the labelled points of the start, px; empty: the run's own points");
  table.Add("recording", &recording, "name",
            "stir: the recording's name in that file; may be left out where it has one alone");
}

std::array<std::uint8_t, 3> TimeColor(const RunSource& source, const SourceFrame& frame) {
  // Nine of viridis' 256 colors, evenly spaced.
  constexpr std::array<std::array<double, 3>, 9> kColors = {{{68, 1, 84},
                                                             {71, 44, 122},
                                                             {59, 81, 139},
                                                             {44, 113, 142},
                                                             {33, 144, 141},
                                                             {39, 173, 129},
                                                             {92, 200, 99},
                                                             {170, 220, 50},
                                                             {253, 231, 37}}};
  const double first = source.frames.front().frame_idx;
  const double length = std::max(1.0, source.frames.back().frame_idx - first);
  const double position = (frame.frame_idx - first) / length * (kColors.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(position), kColors.size() - 2);
  std::array<std::uint8_t, 3> color{};
  for (std::size_t c = 0; c < 3; ++c)
    color[c] = static_cast<std::uint8_t>(
        std::lround(std::lerp(kColors[below][c], kColors[below + 1][c], position - static_cast<double>(below))));
  return color;
}

std::string NumberOf(const SourceFrame& frame) {
  std::string text = std::to_string(frame.frame_idx);
  return text.insert(0, 6 - std::min<std::size_t>(6, text.size()), '0');
}

Status ExportTum(const RunSource& source, const ExportOptions& /*options*/, const ExportFolder& folder) {
  std::string lines;
  for (const SourceFrame& frame : source.frames)
    AppendTumLine(&lines, frame.timestamp_s, frame.cam_from_world.Inverse());
  return WriteFileAtomically(folder.Path("trajectory.txt"), lines);
}

Status ExportFolder::AddFolder(const std::string& name) const { return MakeFolder(Path(name)); }

Result<ExportSummary> ExportRun(const ExportRequest& request, const ExportOptions& options,
                                const JobProgress& progress) {
  const auto format = FindFormat(request.format);
  if (!format.ok()) return format.status();
  if (Status status = CheckNeeds(**format, request); !status.ok()) return status;
  if (Status status = CheckOutput(request.output_path); !status.ok()) return status;
  auto sources = ReadRunSources(request, options.stride);
  if (!sources.ok()) return sources.status();
  for (RunSource& source : *sources) source.progress = progress;
  auto staged = StagedFolder::Create(request.output_path, {});
  if (!staged.ok()) return staged.status();
  ExportSummary summary;
  for (std::size_t k = 0; k < sources->size(); ++k) {
    const RunSource& source = (*sources)[k];
    const std::string submap = sources->size() > 1 ? "/" + std::to_string(k) : "";
    const ExportFolder folder{staged->path().string() + submap, request.output_path + submap};
    if (Status status = MakeFolder(folder.path); !status.ok()) return status;
    if (Status status = (*format)->write(source, options, folder); !status.ok()) return status;
    summary.frames += static_cast<int>(source.frames.size());
    summary.points += static_cast<int>(source.points.size());
    summary.observations += source.num_observations;
    summary.notes.insert(summary.notes.end(), source.notes.begin(), source.notes.end());
  }
  if (Status status = staged->Commit(); !status.ok()) return status;
  if (sources->size() > 1)
    summary.notes.push_back("the run has " + std::to_string(sources->size()) +
                            " submaps, each with its own world and unit: one folder each");
  return summary;
}

}  // namespace pliant
