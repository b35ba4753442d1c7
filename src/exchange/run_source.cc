// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "exchange/run_source.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "exchange/run_images.h"
#include "pliant/base/text.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/datasets/run_sequence.h"
#include "pliant/io/run_map.h"

namespace pliant {
namespace {

// Counts and mean errors, and the first position of points that sparse/ does not have.
Status AddPoints(const RunMap& known, RunSource* source) {
  std::map<PointId, CanonicalPoint> points;
  std::size_t unknown = 0;
  Status status = ForEachFrame(*source, [&](const SourceFrame& frame, const auto& observations) {
    for (const PointObservation& o : observations) {
      const auto [entry, added] = points.try_emplace(o.id);
      CanonicalPoint& point = entry->second;
      if (added) {
        const auto found = known.points.find(o.id);
        point.point = found != known.points.end() ? found->second : NewPoint{o.id, o.position};
        unknown += found == known.points.end() ? 1 : 0;
      }
      CountObservation(source->camera, frame.cam_from_world, o, &point);
      ++source->num_observations;
    }
    return Status::Ok();
  });
  if (!status.ok()) return status;
  for (const auto& [id, point] : points) source->points.push_back(point);
  if (unknown > 0)
    source->notes.push_back(std::to_string(unknown) + " of " + std::to_string(points.size()) +
                            " points are not in the run's sparse/, which is written at the end and has those seen in "
                            "two frames or more; their first position stands for the undeformed one, in gray");
  return Status::Ok();
}

// The frames to export, by submap, without their points.
Result<std::map<int, RunSource>> ChooseFrames(const Run& run, const RunMap& known, const RunSource& empty, int stride,
                                              int* without_depth) {
  std::map<int, RunSource> sources;
  for (std::size_t i = 0; i < run.poses.size(); i += static_cast<std::size_t>(stride)) {
    const RunPose& pose = run.poses[i];
    if (!pose.frame_idx)
      return Status(ErrorCode::kMismatch, Quoted(empty.run_path) +
                                              " has no frames.csv, so it is another program's; make it a run with "
                                              "pliant import --format result");
    const auto name = known.names.find(*pose.frame_idx);
    if (name == known.names.end())
      return Status(ErrorCode::kMismatch, "frame " + std::to_string(*pose.frame_idx) + " of the run " +
                                              Quoted(empty.run_path) + " has no image; is this its sequence?");
    if (empty.surface && FindFrame(*empty.surface, *pose.frame_idx) == nullptr) {
      ++*without_depth;
      continue;
    }
    RunSource& source = sources.try_emplace(pose.submap, empty).first->second;
    source.frames.push_back({*pose.frame_idx, pose.timestamp_s, name->second, pose.world_from_cam.Inverse()});
  }
  if (sources.empty())
    return Status(ErrorCode::kInsufficient,
                  "the surface has a depth of none of the frames to export; make one of more "
                  "frames with pliant surface, or export without --surface");
  return sources;
}

}  // namespace

Result<std::vector<RunSource>> ReadRunSources(const ExportRequest& request, int stride) {
  const auto run = ReadRun(request.run_path);
  if (!run.ok()) return run.status();
  if (run->poses.empty())
    return Status(ErrorCode::kInsufficient,
                  "no frame of the run " + Quoted(request.run_path) + " was tracked; there is nothing to export");
  SequenceRequest images = SequenceOfRun(request.run_path, request.sequence_path, request.camera_path);
  if (!request.mask_path.empty()) images.mask_path = request.mask_path;
  const auto known = KnownMapOfRun(request.run_path, images, *run);
  if (!known.ok()) return known.status();
  // Also of formats that hold no images; images that cannot be read are an error where they are needed.
  if (!request.sequence_path.empty())
    if (const auto sequence = OpenSequence(images); sequence.ok())
      if (Status status = CheckCameraOfImages(images, *run, *known->camera, (*sequence)->camera()); !status.ok())
        return status;
  RunSource empty{request.run_path, std::make_shared<const Run>(*run), *known->camera, images, {}, {}, {}, 0, {}};
  if (!request.surface_path.empty()) {
    auto surface = ReadSurfaceOfRun(request.surface_path, request.run_path, *known);
    if (!surface.ok()) return surface.status();
    empty.surface = *std::move(surface);
  }
  int without_depth = 0;
  auto sources = ChooseFrames(*run, *known, empty, stride, &without_depth);
  if (!sources.ok()) return sources.status();
  std::vector<RunSource> in_order;
  for (auto& [submap, source] : *sources) {
    if (Status status = AddPoints(*known, &source); !status.ok()) return status;
    in_order.push_back(std::move(source));
  }
  std::vector<std::string>& notes = in_order.front().notes;
  if (run->cut_lines > 0) notes.emplace_back("the run was killed; its complete rows are exported");
  if (without_depth > 0)
    notes.push_back(std::to_string(without_depth) +
                    " tracked frames have no depth in the surface and are left out: the programs that read this "
                    "format want a depth of all frames or of none");
  return in_order;
}

bool IsMetric(const RunSource& source) {
  const auto& summary = source.run->summary;
  return summary && summary->description.metric.value_or(false);
}

Status ForEachFrame(const RunSource& source, const FrameFunction& function) {
  std::vector<int> frames_idx;
  for (const SourceFrame& frame : source.frames) frames_idx.push_back(frame.frame_idx);
  return ForEachFrame(source.run_path, frames_idx, [&](std::size_t k, const auto& observations) {
    if (Status status = Tell(source.progress, "export", static_cast<int>(k + 1), static_cast<int>(frames_idx.size()));
        !status.ok())
      return status;
    return function(source.frames[k], observations);
  });
}

}  // namespace pliant
