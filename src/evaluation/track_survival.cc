// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/track_survival.h"

#include <map>
#include <set>
#include <utility>
#include <vector>

#include "pliant/base/statistics.h"

namespace pliant {

TrackSurvival ComputeTrackSurvival(std::span<const FrameTracks> frames) {
  TrackSurvival survival;
  std::map<PointId, int> length_of_track;
  std::set<PointId> first_ids;
  for (const FrameTracks& frame : frames) {
    TrackSurvival::Frame row{frame.frame_idx, frame.tracked, 0, 0};
    if (frame.tracked) {
      if (survival.frames_tracked == 0) {
        first_ids.insert(frame.ids.begin(), frame.ids.end());
        survival.first_points = static_cast<int>(frame.ids.size());
      }
      for (const PointId id : frame.ids) {
        ++length_of_track[id];
        if (first_ids.contains(id)) ++row.alive_of_first;
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
  survival.tracks = static_cast<int>(length_of_track.size());
  std::vector<double> lengths;
  for (const auto& entry : length_of_track) lengths.push_back(entry.second);
  survival.median_track_length = Median(std::move(lengths));
  return survival;
}

}  // namespace pliant
