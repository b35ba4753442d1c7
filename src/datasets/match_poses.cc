// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/match_poses.h"

#include <cmath>
#include <iterator>
#include <utility>

#include "pliant/base/text.h"

namespace pliant {
Result<MatchedPoses> MatchPoses(std::span<const TimedPose> poses, const Sequence& sequence, double max_difference_s,
                                const std::string& name) {
  std::map<double, int> frame_at;  // the sequence's frames by time
  for (int i = 0; i < sequence.size(); ++i)
    if (const auto time_s = sequence.TimestampS(i)) frame_at.emplace(*time_s, i);
  if (frame_at.empty())
    return Status(ErrorCode::kMismatch,
                  "the sequence has no times to which the poses of " + name + " could be matched");
  std::map<int, std::pair<double, const TimedPose*>> nearest;  // by frame number
  for (const TimedPose& pose : poses) {
    auto after = frame_at.lower_bound(pose.timestamp_s);
    if (after == frame_at.end() ||
        (after != frame_at.begin() && pose.timestamp_s - std::prev(after)->first < after->first - pose.timestamp_s))
      --after;
    const double difference_s = std::abs(after->first - pose.timestamp_s);
    if (difference_s > max_difference_s) continue;
    const auto [it, is_new] = nearest.try_emplace(after->second, difference_s, &pose);
    if (!is_new && difference_s < it->second.first) it->second = {difference_s, &pose};
  }
  if (nearest.empty() && !poses.empty())
    return Status(ErrorCode::kMismatch,
                  "no pose of " + name + " is within " + Seconds(max_difference_s) + " of a frame: its times go from " +
                      Seconds(poses.front().timestamp_s) + " to " + Seconds(poses.back().timestamp_s) +
                      ", the sequence's from " + Seconds(frame_at.begin()->first) + " to " +
                      Seconds(frame_at.rbegin()->first) + "; write times in seconds of the sequence's clock");
  MatchedPoses matched;
  for (const auto& [frame_idx, match] : nearest)
    matched.world_from_cam.emplace(frame_idx, match.second->world_from_cam);
  matched.left_out = static_cast<int>(poses.size() - nearest.size());
  return matched;
}

}  // namespace pliant
