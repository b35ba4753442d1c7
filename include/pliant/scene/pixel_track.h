// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Where a point is in the images of a sequence, without anything in 3D: what point trackers give.
#pragma once

#include <algorithm>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/ids.h"

namespace pliant {

struct TrackPixel {
  int frame_idx = 0;                                // the sequence's own number
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // finite
  double sigma_px = 0;                              // standard deviation of a coordinate; 0: not known
  bool visible = true;                              // false: where the point is thought to be, hidden
};

struct PixelTrack {
  PointId id;
  std::vector<TrackPixel> pixels;  // ascending frames, each once
};

// What a track says of a frame, or null.
inline const TrackPixel* PixelIn(const PixelTrack& track, int frame_idx) {
  const auto found = std::ranges::lower_bound(track.pixels, frame_idx, {}, &TrackPixel::frame_idx);
  return found != track.pixels.end() && found->frame_idx == frame_idx ? &*found : nullptr;
}

}  // namespace pliant
