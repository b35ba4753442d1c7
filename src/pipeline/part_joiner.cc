// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/part_joiner.h"

#include <algorithm>
#include <utility>

#include "pliant/io/run_reader.h"

namespace pliant {
namespace {

std::vector<int> SharedFrames(const RunPart& before, const RunPart& after) {
  std::vector<int> frames_idx;
  for (const auto& [frame_idx, pose] : after.poses)
    if (before.poses.contains(frame_idx)) frames_idx.push_back(frame_idx);
  return frames_idx;
}

Result<std::vector<JointView>> ReadViews(const RunPart& part, const std::vector<int>& frames_idx) {
  std::vector<JointView> views;
  const Status status = ForEachFrame(part.path, frames_idx, [&](std::size_t k, const auto& observations) {
    views.push_back({part.poses.at(frames_idx[k])->world_from_cam.Inverse(), observations});
    std::ranges::sort(views.back().observations, {}, &PointObservation::id);
    return Status::Ok();
  });
  if (!status.ok()) return status;
  return views;
}

}  // namespace

PartJoiner::PartJoiner(std::vector<RunPart>* parts, const JoinOptions& options) : parts_(*parts), options_(options) {
  for (std::size_t i = 0; i < parts_.size(); ++i)
    for (const auto& [frame_idx, pose] : parts_[i].poses) {
      const SubmapKey own_world = {i, pose->submap};
      placed_.try_emplace(own_world, PlacedSubmap{own_world, {}});
    }
}

Status PartJoiner::Join(std::size_t after) {
  RunPart& later = parts_[after];
  const RunPart& earlier = parts_[after - 1];
  const std::vector<int> frames_idx = SharedFrames(earlier, later);
  auto before_views = ReadViews(earlier, frames_idx);
  if (!before_views.ok()) return before_views.status();
  auto after_views = ReadViews(later, frames_idx);
  if (!after_views.ok()) return after_views.status();
  std::map<int, std::map<int, std::vector<SharedFrame>>> shared;  // by the submap of the later and of the earlier one
  for (std::size_t k = 0; k < frames_idx.size(); ++k)
    shared[later.poses.at(frames_idx[k])->submap][earlier.poses.at(frames_idx[k])->submap].push_back(
        {std::move((*before_views)[k]), std::move((*after_views)[k])});
  if (shared.empty()) joints_.push_back(Failed(after, 0, "no frame has a pose in both"));
  for (const auto& [submap, by_earlier] : shared) {
    const auto most = std::ranges::max_element(by_earlier, {}, [](const auto& of) { return of.second.size(); });
    JoinSubmaps({after, submap}, {after - 1, most->first}, most->second);
  }
  return Status::Ok();
}

RunJoint PartJoiner::Failed(std::size_t after, std::size_t frames, const std::string& why) const {
  return {
      .run = parts_[after].path, .before = parts_[after - 1].path, .frames = static_cast<int>(frames), .failure = why};
}

void PartJoiner::JoinSubmaps(const SubmapKey& after, const SubmapKey& before, const std::vector<SharedFrame>& frames) {
  RunPart& later = parts_[after.first];
  const JointScale scale = later.description().metric.value_or(false) ? JointScale::kOne : JointScale::kEstimated;
  const auto joint = JoinWorlds(frames, later.known.camera->width(), scale, options_);
  if (!joint.ok()) {
    joints_.push_back(Failed(after.first, frames.size(), joint.status().message()));
    return;
  }
  const PlacedSubmap& of_before = placed_.at(before);
  placed_.at(after) = {of_before.root, of_before.root_from_submap * joint->before_from_after};
  later.same_points.insert(joint->same_points.begin(), joint->same_points.end());
  joints_.push_back({later.path, parts_[before.first].path, static_cast<int>(frames.size()), joint->points,
                     joint->before_from_after.scale, joint->depth_difference, joint->depth_spread,
                     static_cast<int>(joint->same_points.size()), ""});
}

}  // namespace pliant
