// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/align_runs.h"

#include <cmath>
#include <utility>
#include <vector>

#include "pliant/base/statistics.h"
#include "pliant/geometry/alignment.h"
#include "viewer/frame_geometry.h"

namespace pliant {

FramePoses PosesOf(const ViewedRun& run, int submap) {
  FramePoses poses;
  for (const ViewedFrame& frame : run.frames)
    if (frame.world_from_cam && frame.row.submap == submap) poses.emplace(frame.row.frame_idx, *frame.world_from_cam);
  return poses;
}

std::optional<Sim3> AlignWorlds(const FramePoses& from, const FramePoses& to, std::optional<double> scale,
                                double depth_in_from) {
  std::vector<Eigen::Vector3d> from_centers;
  std::vector<Eigen::Vector3d> to_centers;
  for (const auto& [frame_idx, pose] : from)
    if (const auto other = to.find(frame_idx); other != to.end()) {
      from_centers.push_back(pose.translation);
      to_centers.push_back(other->second.translation);
    }
  if (from_centers.empty()) return std::nullopt;
  if (!scale) {
    const Result<Sim3> paths = AlignPoints(from_centers, to_centers, AlignmentScale::kEstimated);
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

FrameDepths DepthsOf(const ViewedRun& run, int submap) {
  FrameDepths depths;
  for (const ViewedFrame& frame : run.frames) {
    if (frame.row.submap != submap) continue;
    if (const auto depth = MedianDepth(frame)) depths.emplace(frame.row.frame_idx, *depth);
  }
  return depths;
}

double MedianOf(const FrameDepths& depths) {
  std::vector<double> values;
  for (const auto& [frame_idx, depth] : depths) values.push_back(depth);
  return values.empty() ? 1.0 : Median(std::move(values));
}

std::optional<double> DepthRatio(const FrameDepths& from, const FrameDepths& to) {
  std::vector<double> ratios;
  for (const auto& [frame_idx, depth] : from)
    if (const auto other = to.find(frame_idx); other != to.end()) ratios.push_back(other->second / depth);
  if (ratios.empty()) return std::nullopt;
  return Median(std::move(ratios));
}

}  // namespace pliant
