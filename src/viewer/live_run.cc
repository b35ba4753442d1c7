// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/live_run.h"

#include <utility>

#include "viewer/read_run.h"

namespace pliant {

void LiveRun::Add(const FrameReport& report) {
  ViewedFrame frame;
  frame.row = {report.frame_idx,
               report.timestamp_s,
               report.state,
               report.tracked,
               report.optimized,
               report.lost,
               report.added,
               report.costs,
               report.median_reprojection_error_px,
               report.submap,
               {}};
  if (run_.stage_names.empty())
    for (const auto& [stage, ms] : report.stage_ms) run_.stage_names.push_back(stage);
  for (const auto& [stage, ms] : report.stage_ms) frame.row.stage_ms.push_back(ms);
  frame.note = report.note;
  for (const NewPoint& point : report.new_points) run_.points.insert_or_assign(point.id, point);
  for (const RefinedPoint& point : report.refined_points) {
    run_.points[point.id].position = point.position;
    refined_in_[point.id] = rows();
  }
  if (report.cam_from_world) frame.world_from_cam = report.cam_from_world->Inverse();
  for (const PointObservation& o : report.observations) {
    frame.observations.push_back(ToViewed(o));
    run_.points.try_emplace(o.id, NewPoint{o.id, o.position});
  }
  AddWhatPoseTells(run_.camera ? &*run_.camera : nullptr, &frame);
  frames_.push_back(std::make_shared<const ViewedFrame>(std::move(frame)));
  if (!report.merge) return;
  for (const auto& kept : frames_) run_.frames.push_back(*kept);
  Move(report.merge->into_from_submap, report.merge->submap, &run_);
  frames_.clear();
  for (ViewedFrame& merged : run_.frames) {
    if (merged.row.submap == report.merge->submap) merged.row.submap = report.merge->into;
    frames_.push_back(std::make_shared<const ViewedFrame>(std::move(merged)));
  }
  run_.frames.clear();
  ++epoch_;
}

LiveRun::Part LiveRun::From(int row) const {
  Part part{run_, {frames_.begin() + row, frames_.end()}, {}};
  for (const auto& [id, refined_in] : refined_in_)
    if (refined_in >= row) part.refined.insert(id);
  return part;
}

ViewedRun LiveRun::Part::ToRun() && {
  for (const auto& frame : frames) {
    run.frames.push_back(*frame);
    for (const ViewedObservation& o : frame->observations) refined.insert(o.id);
  }
  std::erase_if(run.points, [&](const auto& point) { return !refined.contains(point.first); });
  return std::move(run);
}

}  // namespace pliant
