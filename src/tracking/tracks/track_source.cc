// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/tracks/track_source.h"

namespace pliant {

std::vector<NewTrack> TrackSource::AddNew(const PreparedFrame& frame, std::span<const Eigen::Vector2d> existing,
                                          const CornerOptions& corners) {
  std::vector<NewTrack> added;
  for (const Corner& corner : DetectCorners(frame.gray, frame.mask.valid(), existing, corners))
    if (const auto id = Add(corner.pixel, frame)) added.push_back({*id, corner.pixel});
  return added;
}

}  // namespace pliant
