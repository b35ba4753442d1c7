// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/run_consistency.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/seen_points.h"
#include "geometry/nearest_pixels.h"

namespace pliant {
namespace {

// The tracked frames of the other run, by the number that they have in the run.
std::map<int, const EvaluationFrame*> FramesOf(const EvaluationInput& other, FrameOrder order) {
  int last = 0;
  for (const EvaluationFrame& frame : other.frames) last = std::max(last, frame.frame_idx);
  std::map<int, const EvaluationFrame*> frames;
  for (const EvaluationFrame& frame : other.frames)
    if (frame.cam_from_world)
      frames.emplace(order == FrameOrder::kSame ? frame.frame_idx : last - frame.frame_idx, &frame);
  return frames;
}

std::vector<DepthPair> PairPoints(const EvaluationFrame& frame, const EvaluationFrame& other, double radius_px) {
  const SeenPoints others = SeenPointsOf(other);
  const NearestPixels nearest(others.pixels, radius_px);
  const SeenPoints points = SeenPointsOf(frame);
  std::vector<DepthPair> pairs;
  for (std::size_t i = 0; i < points.pixels.size(); ++i)
    for (const auto& neighbor : nearest.Find(points.pixels[i], 1))
      pairs.push_back({points.depths[i], others.depths[neighbor.idx]});
  return pairs;
}

}  // namespace

void RunConsistencyOptions::List(OptionTable& table) {
  table.Add("max_distance", &max_distance, "of the image's width", "between two points that are compared", 0.0001, 1.0);
  table.Add("min_points", &min_points, "points", "compared in a frame that counts", 1, 1000000);
  table.AddChoice(
      "order", &order,
      "how the other run's frames are numbered: same, as the run's; reversed, its images are the run's from "
      "the last to the first");
}

Result<RelativeDepthError> CompareRuns(const EvaluationInput& run, const EvaluationInput& other, int width_px,
                                       const RunConsistencyOptions& options) {
  const std::map<int, const EvaluationFrame*> others = FramesOf(other, options.order);
  std::vector<RelativeDepthFrame> frames;
  int common = 0;
  for (const EvaluationFrame& frame : run.frames) {
    const auto same = others.find(frame.frame_idx);
    if (!frame.cam_from_world || same == others.end()) continue;
    ++common;
    const auto pairs = PairPoints(frame, *same->second, options.max_distance * width_px);
    if (static_cast<int>(pairs.size()) >= options.min_points)
      frames.push_back(CompareDepths(frame.frame_idx, pairs, NullDepths::kOfRun));
  }
  return Summarize(std::move(frames), "the runs " + run.name + " and " + other.name + " have " +
                                          std::to_string(common) + " tracked frames in common, and none of them has " +
                                          std::to_string(options.min_points) +
                                          " points at the same pixels; compare runs of one recording");
}

Result<TrajectoryError> CompareCameraPaths(const EvaluationInput& run, const EvaluationInput& other,
                                           const RunConsistencyOptions& options,
                                           const TrajectoryErrorOptions& trajectory) {
  const std::map<int, const EvaluationFrame*> others = FramesOf(other, options.order);
  std::map<std::pair<int, int>, int> worlds;  // of a submap of the run and one of the other
  std::vector<PosePair> pairs;
  for (const EvaluationFrame& frame : run.frames) {
    const auto same = others.find(frame.frame_idx);
    if (!frame.cam_from_world || same == others.end()) continue;
    const auto [world, is_new] =
        worlds.try_emplace({frame.submap, same->second->submap}, static_cast<int>(worlds.size()));
    pairs.push_back(
        {frame.frame_idx, frame.cam_from_world->Inverse(), same->second->cam_from_world->Inverse(), world->second});
  }
  return ComputeTrajectoryError(pairs, trajectory);
}

}  // namespace pliant
