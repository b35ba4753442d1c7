// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/run_joint.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "geometry/nearest_pixels.h"
#include "pliant/base/statistics.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

constexpr int kMinSameFrames = 3;  // in which a point of each is at one place

struct ComparedDepths {
  double before = 0;
  double after = 0;
};

double DepthOf(const JointView& view, const PointObservation& seen) {
  return (view.cam_from_world * seen.position).z();
}

std::vector<Eigen::Vector2d> PixelsOf(const std::vector<PointObservation>& observations) {
  std::vector<Eigen::Vector2d> pixels;
  for (const PointObservation& seen : observations) pixels.push_back(seen.pixel);
  return pixels;
}

void AddPairs(const SharedFrame& frame, double radius_px, std::vector<ComparedDepths>* pairs) {
  const NearestPixels nearest(PixelsOf(frame.before.observations), radius_px);
  for (const PointObservation& seen : frame.after.observations) {
    const double after = DepthOf(frame.after, seen);
    for (const auto& neighbor : nearest.Find(seen.pixel, 1)) {
      const double before = DepthOf(frame.before, frame.before.observations[neighbor.idx]);
      if (before > 0.0 && after > 0.0) pairs->push_back({before, after});
    }
  }
}

double MedianAbsLog(std::vector<double> ratios, double by) {
  for (double& ratio : ratios) ratio = std::abs(std::log(ratio / by));
  return Median(std::move(ratios));
}

// (J1) Means over the frames; rotations differ by little.
Sim3 WorldsFromPoses(std::span<const SharedFrame> frames, double scale) {
  Eigen::Vector4d rotations = Eigen::Vector4d::Zero();
  std::vector<Sim3> worlds;
  for (const SharedFrame& frame : frames) {
    worlds.push_back(WorldFromPoses(frame.before.cam_from_world, frame.after.cam_from_world, scale));
    const Eigen::Vector4d& rotation = worlds.back().rotation.coeffs();
    rotations += rotation.dot(worlds.front().rotation.coeffs()) < 0.0 ? Eigen::Vector4d(-rotation) : rotation;
  }
  Sim3 mean{scale, Eigen::Quaterniond(rotations).normalized(), Eigen::Vector3d::Zero()};
  for (const SharedFrame& frame : frames)
    mean.translation += (frame.before.cam_from_world.Inverse().translation -
                         mean.Turn(frame.after.cam_from_world.Inverse().translation)) /
                        static_cast<double>(frames.size());
  return mean;
}

std::ptrdiff_t FramesOfBoth(std::span<const SharedFrame> frames, PointId after, PointId before) {
  return std::ranges::count_if(frames, [&](const SharedFrame& frame) {
    return FindById(frame.after.observations, after) != nullptr &&
           FindById(frame.before.observations, before) != nullptr;
  });
}

// (J2) A point of each that are nearest to each other, and near, in most frames in which both are seen.
std::map<PointId, PointId> SamePoints(std::span<const SharedFrame> frames, double radius_px) {
  std::map<std::pair<PointId, PointId>, int> together;  // after's, before's
  for (const SharedFrame& frame : frames) {
    const NearestPixels before(PixelsOf(frame.before.observations), radius_px);
    const NearestPixels after(PixelsOf(frame.after.observations), radius_px);
    for (std::size_t i = 0; i < frame.after.observations.size(); ++i) {
      const PointObservation& seen = frame.after.observations[i];
      const auto nearest = before.Find(seen.pixel, 1);
      if (nearest.empty()) continue;
      const PointObservation& other = frame.before.observations[nearest.front().idx];
      const auto back = after.Find(other.pixel, 1);
      if (back.front().idx == i) ++together[{seen.id, other.id}];
    }
  }
  std::map<PointId, PointId> same;
  for (const auto& [ids, count] : together) {
    if (count < kMinSameFrames) continue;
    if (2 * count > FramesOfBoth(frames, ids.first, ids.second)) same.emplace(ids);
  }
  return same;
}

// Each of before's once, by the pair that comes first.
std::map<PointId, PointId> OneToOne(const std::map<PointId, PointId>& same) {
  std::map<PointId, PointId> chosen;
  std::map<PointId, PointId> taken;
  for (const auto& [after, before] : same)
    if (taken.emplace(before, after).second) chosen.emplace(after, before);
  return chosen;
}

}  // namespace

Result<WorldJoint> JoinWorlds(std::span<const SharedFrame> frames, int width_px, JointScale scale,
                              const JoinOptions& options) {
  std::vector<ComparedDepths> pairs;
  for (const SharedFrame& frame : frames) AddPairs(frame, options.max_distance * width_px, &pairs);
  if (static_cast<int>(pairs.size()) < options.min_points)
    return Status(ErrorCode::kInsufficient, "their " + std::to_string(frames.size()) + " common frames have " +
                                                std::to_string(pairs.size()) + " points at the same pixels, at least " +
                                                std::to_string(options.min_points) + " are needed");
  std::vector<double> ratios;
  std::vector<double> depths;
  for (const ComparedDepths& pair : pairs) {
    ratios.push_back(pair.before / pair.after);
    depths.push_back(pair.before);
  }
  WorldJoint joint;
  const double unit = scale == JointScale::kOne ? 1.0 : Median(ratios);
  joint.before_from_after = WorldsFromPoses(frames, unit);
  joint.points = static_cast<int>(pairs.size());
  joint.depth_difference = MedianAbsLog(ratios, unit);
  joint.depth_spread = MedianAbsLog(depths, Median(depths));
  if (joint.depth_difference > options.max_depth_difference)
    return Status(ErrorCode::kInsufficient,
                  "in their " + std::to_string(frames.size()) + " common frames the depths differ by " +
                      Digits(100.0 * joint.depth_difference, 1) + " %, at most " +
                      Digits(100.0 * options.max_depth_difference, 1) + " % are allowed: one of the maps is wrong");
  joint.same_points = OneToOne(SamePoints(frames, options.max_same_distance * width_px));
  return joint;
}

}  // namespace pliant
