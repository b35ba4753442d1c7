// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "refinement/check_recording.h"

#include <cstddef>
#include <string>

namespace pliant {

Status CheckRecording(const Recording& recording, const RefineOptions& options) {
  const std::size_t views = recording.times.size();
  if (views < 2 || std::ssize(recording.rest_positions) < kMinRefinedPoints)
    return {ErrorCode::kInsufficient, "a refinement needs 2 frames and " + std::to_string(kMinRefinedPoints) +
                                          " points, and there are " + std::to_string(views) + " and " +
                                          std::to_string(recording.rest_positions.size())};
  if (recording.cams_from_world.size() != views || options.rank < 1 || !(recording.log_depth_sigma > 0))
    return {ErrorCode::kInvalidArgument,
            "a recording needs a time and a pose for every view, a rank and a sigma above 0"};
  for (std::size_t v = 1; v < views; ++v)
    if (!(recording.times[v] > recording.times[v - 1]))
      return {ErrorCode::kInvalidArgument, "the times of a recording must ascend"};
  for (const RecordedObservation& o : recording.observations) {
    const bool known = o.view_idx >= 0 && static_cast<std::size_t>(o.view_idx) < views && o.point_idx >= 0 &&
                       static_cast<std::size_t>(o.point_idx) < recording.rest_positions.size();
    if (!known || !o.pixel.allFinite() || !o.position.allFinite())
      return {ErrorCode::kInvalidArgument, "an observation of a recording has an index or a number that is none"};
  }
  return Status::Ok();
}

}  // namespace pliant
