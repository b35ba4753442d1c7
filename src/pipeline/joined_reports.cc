// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/joined_reports.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "pipeline/run_frames.h"

namespace pliant {

FrameReport JoinedReports::Report(std::size_t part_idx, int frame_idx, std::vector<PointObservation> observations) {
  const RunPart& part = parts_[part_idx];
  const RunFrame& frame = *part.frames.at(frame_idx);
  FrameReport report = ReportOf(frame, part.known);
  report.submap = submap_;
  report.latency_ms = frame.latency_ms;
  if (!HasPose(frame.state)) return report;
  const RunPose& pose = *part.poses.at(frame_idx);
  const PlacedSubmap& placed = joiner_.PlaceOf({part_idx, pose.submap});
  report.submap = submap_ = numbers_.try_emplace(placed.root, static_cast<int>(numbers_.size())).first->second;
  report.cam_from_world = PoseInWorld(placed.root_from_submap, pose.world_from_cam.Inverse());
  Take(part_idx, placed.root_from_submap, std::move(observations), &report);
  CompleteReport(part.run, *part.known.camera, &report);
  if (placed.root == SubmapKey{part_idx, pose.submap}) AddEarlierFirstMap(part, pose.submap, &report);
  return report;
}

// A map of its own that was declared before the first frame that this part has in the joined run.
void JoinedReports::AddEarlierFirstMap(const RunPart& part, int submap, FrameReport* report) {
  if (!begun_.insert(report->submap).second || report->first_map) return;
  for (const FirstMapFrames& map : part.run.summary->first_maps) {
    const auto declared = part.frames.find(map.declared_frame_idx);
    if (declared == part.frames.end() || declared->second->submap != submap) continue;
    if (map.declared_frame_idx < report->frame_idx) report->first_map = map;
    return;
  }
}

// In the joined run, whose ids grow in the order of the points' first frames.
std::pair<PointId, bool> JoinedReports::JoinedId(std::size_t part_idx, PointId id) {
  const std::map<PointId, PointId>* same = &parts_[part_idx].same_points;
  for (auto before = same->find(id); before != same->end(); before = same->find(id)) {
    id = before->second;
    same = &parts_[--part_idx].same_points;
  }
  const auto [entry, is_new] = ids_.try_emplace({part_idx, id}, PointId{std::ssize(ids_)});
  return {entry->second, is_new};
}

void JoinedReports::Take(std::size_t part_idx, const Sim3& root_from_submap, std::vector<PointObservation> observations,
                         FrameReport* report) {
  const std::map<PointId, NewPoint>& points = parts_[part_idx].known.points;
  for (PointObservation& seen : observations) {
    const auto known = points.find(seen.id);
    NewPoint point = known != points.end() ? known->second : NewPoint{seen.id, seen.position};
    const auto [id, is_new] = JoinedId(part_idx, seen.id);
    point.id = seen.id = id;
    point.position = root_from_submap * point.position;
    seen.position = root_from_submap * seen.position;
    seen.sigma *= root_from_submap.scale;
    if (is_new) report->new_points.push_back(point);
  }
  std::ranges::sort(observations, {}, &PointObservation::id);
  std::ranges::sort(report->new_points, {}, &NewPoint::id);
  report->observations = std::move(observations);
}

}  // namespace pliant
