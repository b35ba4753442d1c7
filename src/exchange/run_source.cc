// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "exchange/run_source.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "pliant/base/text.h"
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

}  // namespace

Result<std::vector<RunSource>> ReadRunSources(const std::string& run_path, const std::string& sequence_path,
                                              int stride) {
  const auto run = ReadRun(run_path);
  if (!run.ok()) return run.status();
  if (run->poses.empty())
    return Status(ErrorCode::kInsufficient,
                  "no frame of the run " + Quoted(run_path) + " was tracked; there is nothing to export");
  auto known = KnownMapOfRun(run_path, SequenceOfRun(run_path, sequence_path), *run);
  if (!known.ok()) return known.status();
  std::map<int, RunSource> sources;  // by submap
  for (std::size_t i = 0; i < run->poses.size(); i += static_cast<std::size_t>(stride)) {
    const RunPose& pose = run->poses[i];
    if (!pose.frame_idx)
      return Status(ErrorCode::kMismatch, Quoted(run_path) +
                                              " has no frames.csv, so it is another program's; make it a run with "
                                              "pliant import --format result");
    const auto name = known->names.find(*pose.frame_idx);
    if (name == known->names.end())
      return Status(ErrorCode::kMismatch, "frame " + std::to_string(*pose.frame_idx) + " of the run " +
                                              Quoted(run_path) + " has no image; is this its sequence?");
    RunSource& source =
        sources.try_emplace(pose.submap, RunSource{run_path, *known->camera, {}, {}, 0, {}}).first->second;
    source.frames.push_back({*pose.frame_idx, pose.timestamp_s, name->second, pose.world_from_cam.Inverse()});
  }
  std::vector<RunSource> in_order;
  for (auto& [submap, source] : sources) {
    if (Status status = AddPoints(*known, &source); !status.ok()) return status;
    in_order.push_back(std::move(source));
  }
  if (run->cut_lines > 0) in_order.front().notes.emplace_back("the run was killed; its complete rows are exported");
  return in_order;
}

Status ForEachFrame(const RunSource& source, const FrameFunction& function) {
  std::vector<int> frames_idx;
  for (const SourceFrame& frame : source.frames) frames_idx.push_back(frame.frame_idx);
  return ForEachFrame(source.run_path, frames_idx, [&](std::size_t k, const auto& observations) {
    return function(source.frames[k], observations);
  });
}

}  // namespace pliant
