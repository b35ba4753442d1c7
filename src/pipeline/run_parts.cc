// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/run_parts.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "pipeline/run_frames.h"
#include "pliant/base/text.h"
#include "pliant/camera/same_camera.h"
#include "pliant/datasets/run_sequence.h"

namespace pliant {
namespace {

Status CheckSubmapsOfPoints(const std::string& path, const Run& run, const std::vector<int>& frames_idx) {
  if (run.summary && run.summary->status != RunStatus::kInterrupted) return Status::Ok();  // they were written again
  std::unordered_map<PointId, int> submap_of;
  return ForEachFrame(path, frames_idx, [&](std::size_t k, const auto& observations) {
    for (const PointObservation& seen : observations) {
      const int submap = run.poses[k].submap;
      if (Status one = CheckOneSubmap(submap_of.try_emplace(seen.id, submap).first->second, submap, seen.id); !one.ok())
        return one;
    }
    return Status::Ok();
  });
}

Result<RunPart> ReadPart(const std::string& path, const JoinRequest& request) {
  RunPart part;
  part.path = path;
  auto run = ReadRun(path);
  if (!run.ok()) return run.status();
  part.run = *std::move(run);
  const auto frames_idx = FramesWithPose(path, part.run);
  if (!frames_idx.ok()) return frames_idx.status();
  if (Status status = CheckSubmapsOfPoints(path, part.run, *frames_idx); !status.ok()) return status;
  if (!part.run.summary || part.run.frames.empty())
    return Status(ErrorCode::kInsufficient, "the run " + Quoted(path) + " has no frames; there is nothing to join");
  auto known = KnownMapOfRun(path, SequenceOfRun(path, request.sequence_path, request.camera_path), part.run);
  if (!known.ok()) return known.status();
  part.known = *std::move(known);
  for (const RunFrame& frame : part.run.frames) part.frames.emplace(frame.frame_idx, &frame);
  for (const RunPose& pose : part.run.poses) part.poses.emplace(*pose.frame_idx, &pose);
  return part;
}

// That the parts are of one recording.
Status CheckSame(const RunPart& first, const RunPart& other) {
  const auto differs = [&](const std::string& what) {
    return Status(ErrorCode::kMismatch, "the runs " + Quoted(first.path) + " and " + Quoted(other.path) + " are of " +
                                            what + "; join parts of one recording");
  };
  if (first.description().input != other.description().input) return differs("different images");
  if (first.description().range.stride != other.description().range.stride) return differs("different frames");
  if (first.description().metric != other.description().metric) return differs("different units");
  if (!IsSameCamera(*first.known.camera, *other.known.camera)) return differs("different calibrations");
  return Status::Ok();
}

}  // namespace

Result<std::vector<RunPart>> ReadParts(const JoinRequest& request, const JobProgress& progress) {
  std::vector<RunPart> parts;
  for (const std::string& path : request.run_paths) {
    auto part = ReadPart(path, request);
    if (!part.ok()) return part.status();
    parts.push_back(*std::move(part));
    const int read = static_cast<int>(parts.size());
    if (Status status = Tell(progress, "read", read, static_cast<int>(request.run_paths.size())); !status.ok())
      return status;
    if (Status status = CheckSame(parts.front(), parts.back()); !status.ok()) return status;
  }
  std::ranges::sort(parts, {}, [](const RunPart& part) { return std::pair(part.first_frame(), part.last_frame()); });
  if (std::ranges::all_of(parts, [](const RunPart& part) { return part.poses.empty(); }))
    return Status(ErrorCode::kInsufficient, "no frame of the runs was tracked; there is nothing to join");
  return parts;
}

std::map<int, std::size_t> PartOfFrames(const std::vector<RunPart>& parts) {
  std::map<int, std::size_t> part_of;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const int middle = i == 0 ? parts[i].first_frame() : (parts[i].first_frame() + parts[i - 1].last_frame() + 1) / 2;
    for (const auto& [frame_idx, frame] : parts[i].frames) {
      const auto [entry, is_new] = part_of.try_emplace(frame_idx, i);
      if (is_new) continue;
      const bool has_pose = HasPose(frame->state);
      const bool other_has = HasPose(parts[entry->second].frames.at(frame_idx)->state);
      if (has_pose == other_has ? frame_idx >= middle : has_pose) entry->second = i;
    }
  }
  return part_of;
}

}  // namespace pliant
