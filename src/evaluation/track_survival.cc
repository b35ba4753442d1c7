// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/track_survival.h"

#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

// `last_seen`: of each of the first frame's points, the position in the list of frames read.
void FillAliveShares(const std::map<PointId, std::size_t>& last_seen, std::size_t first, TrackSurvival* survival) {
  const std::size_t way = survival->frames.size() - 1 - first;
  for (std::size_t k = 0; k < survival->alive_shares.size(); ++k) {
    const double part = static_cast<double>(k + 1) / static_cast<double>(survival->alive_shares.size());
    const auto rank = first + static_cast<std::size_t>(std::lround(part * static_cast<double>(way)));
    std::size_t alive = 0;
    for (const auto& entry : last_seen)
      if (entry.second >= rank) ++alive;
    survival->alive_shares[k] = static_cast<double>(alive) / static_cast<double>(last_seen.size());
  }
}

void CountInterruptions(std::span<const FrameTracks> frames, TrackSurvival* survival) {
  const FrameTracks* last_tracked = nullptr;
  bool interrupted = false;
  std::set<int> submaps;
  for (const FrameTracks& frame : frames) {
    if (frame.tracked) {
      if (interrupted && frame.submap == last_tracked->submap) ++survival->interruptions_survived;
      submaps.insert(frame.submap);
      last_tracked = &frame;
    } else if (last_tracked != nullptr && !interrupted) {
      ++survival->interruptions;
    }
    interrupted = last_tracked != nullptr && !frame.tracked;
  }
  survival->submaps = static_cast<int>(submaps.size());
}

int CountReturnedPoints(std::span<const FrameTracks> frames) {
  std::map<PointId, int> last_seen;  // by the tracked frames' order
  std::set<PointId> returned;
  int order = 0;
  for (const FrameTracks& frame : frames) {
    if (!frame.tracked) continue;
    ++order;
    for (const PointId id : frame.ids) {
      const auto [entry, is_new] = last_seen.try_emplace(id, order);
      if (!is_new && entry->second + 1 < order) returned.insert(id);
      entry->second = order;
    }
  }
  return static_cast<int>(returned.size());
}

}  // namespace

TrackSurvival ComputeTrackSurvival(std::span<const FrameTracks> frames) {
  TrackSurvival survival;
  std::map<PointId, int> length_of_track;
  std::map<PointId, std::size_t> last_seen;  // of the first tracked frame's points
  std::size_t first = 0;
  for (const FrameTracks& frame : frames) {
    TrackSurvival::Frame row{frame.frame_idx, frame.tracked, 0, 0};
    if (frame.tracked) {
      if (survival.frames_tracked == 0) {
        first = survival.frames.size();
        for (const PointId id : frame.ids) last_seen[id] = first;
        survival.first_points = static_cast<int>(frame.ids.size());
      }
      for (const PointId id : frame.ids) {
        ++length_of_track[id];
        const auto of_first = last_seen.find(id);
        if (of_first == last_seen.end()) continue;
        of_first->second = survival.frames.size();
        ++row.alive_of_first;
      }
      row.points = static_cast<int>(frame.ids.size());
      ++survival.frames_tracked;
      survival.last_points = row.points;
      survival.last_alive_of_first = row.alive_of_first;
      survival.mean_points += row.points;
    }
    survival.frames.push_back(row);
  }
  survival.frames_read = static_cast<int>(frames.size());
  if (survival.frames_tracked > 0) survival.mean_points /= survival.frames_tracked;
  if (!last_seen.empty()) FillAliveShares(last_seen, first, &survival);
  survival.tracks = static_cast<int>(length_of_track.size());
  std::vector<double> lengths;
  for (const auto& entry : length_of_track) lengths.push_back(entry.second);
  survival.mean_track_length = Mean(lengths);
  survival.median_track_length = Median(std::move(lengths));
  CountInterruptions(frames, &survival);
  survival.returned_points = CountReturnedPoints(frames);
  return survival;
}

}  // namespace pliant
