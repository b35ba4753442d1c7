// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/live_run.h"

#include "viewer/read_run.h"

namespace pliant {

void LiveRun::Add(const FrameReport& report) {
  ViewedFrame& frame = run_.frames.emplace_back();
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
    refined_in_[point.id] = rows() - 1;
  }
  if (report.cam_from_world) frame.world_from_cam = report.cam_from_world->Inverse();
  for (const PointObservation& o : report.observations) {
    frame.observations.push_back(ToViewed(o));
    run_.points.try_emplace(o.id, NewPoint{o.id, o.position});
  }
  AddWhatPoseTells(run_.camera ? &*run_.camera : nullptr, &frame);
  if (!report.join) return;
  Move(report.join->into_from_submap, report.join->submap, &run_);
  for (ViewedFrame& joined : run_.frames)
    if (joined.row.submap == report.join->submap) joined.row.submap = report.join->into;
  ++epoch_;
}

ViewedRun LiveRun::From(int row) const {
  ViewedRun part;
  part.name = run_.name;
  part.camera = run_.camera;
  part.stage_names = run_.stage_names;
  part.frames.assign(run_.frames.begin() + row, run_.frames.end());
  for (const ViewedFrame& frame : part.frames)
    for (const ViewedObservation& o : frame.observations) part.points.insert(*run_.points.find(o.id));
  for (const auto& [id, refined_in] : refined_in_)
    if (refined_in >= row) part.points.insert(*run_.points.find(id));
  return part;
}

}  // namespace pliant
