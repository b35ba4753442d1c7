// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/align_runs.h"

#include <cmath>
#include <vector>

#include "pliant/base/statistics.h"
#include "pliant/geometry/alignment.h"

namespace pliant {

FramePoses PosesOf(const ViewedRun& run, int submap) {
  FramePoses poses;
  for (const ViewedFrame& frame : run.frames)
    if (frame.world_from_cam && frame.row.submap == submap) poses.emplace(frame.row.frame_idx, *frame.world_from_cam);
  return poses;
}

std::optional<Sim3> AlignWorlds(const FramePoses& from, const FramePoses& to, std::optional<double> scale,
                                double depth_in_from) {
  std::vector<Eigen::Vector3d> from_centres;
  std::vector<Eigen::Vector3d> to_centres;
  for (const auto& [frame_idx, pose] : from)
    if (const auto other = to.find(frame_idx); other != to.end()) {
      from_centres.push_back(pose.translation);
      to_centres.push_back(other->second.translation);
    }
  if (from_centres.empty()) return std::nullopt;
  if (!scale) {
    const Result<Sim3> paths = AlignPoints(from_centres, to_centres, AlignmentScale::kEstimated);
    scale = paths.ok() && paths->scale > 0 && std::isfinite(paths->scale) ? paths->scale : 1.0;
  }
  std::vector<Eigen::Vector3d> from_points;
  std::vector<Eigen::Vector3d> to_points;
  for (const auto& [frame_idx, pose] : from) {
    const auto other = to.find(frame_idx);
    if (other == to.end()) continue;
    for (const Eigen::Vector3d& corner :
         {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)}) {
      from_points.push_back(*scale * (pose * (depth_in_from * corner)));
      to_points.push_back(other->second * (*scale * depth_in_from * corner));
    }
  }
  const Result<Sim3> turned = AlignPoints(from_points, to_points, AlignmentScale::kFixedAtOne);
  if (!turned.ok()) return std::nullopt;
  return *turned * Sim3{*scale};
}

std::optional<double> MedianDepth(const ViewedRun& run, const FramePoses& frames) {
  std::vector<double> depths;
  for (const ViewedFrame& frame : run.frames)
    if (frames.contains(frame.row.frame_idx))
      for (const ViewedObservation& o : frame.observations)
        if (o.depth > 0) depths.push_back(o.depth);
  if (depths.empty()) return std::nullopt;
  return Median(std::move(depths));
}

}  // namespace pliant
