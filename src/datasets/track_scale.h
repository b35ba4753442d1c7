// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Whether point tracks were made in images of another size than those that they are given for. A patch at a track's
// pixel looks the same in another frame; so it does at pixels of another scale only where nothing moves. Compared by
// the correlation of patches, as given and with each axis scaled as from a common size of images, or a simple ratio.
// Says nothing where the tracks fit as they are, where too little moves, and where no scale fits (noise, no texture,
// tracks that follow nothing).
#pragma once

#include <map>
#include <optional>
#include <span>

#include <opencv2/core/mat.hpp>

#include "pliant/scene/pixel_track.h"

namespace pliant {

struct TrackScale {
  int width = 0;  // of the images that the tracks fit, px
  int height = 0;
  double correlation = 0;        // of patches along the tracks with this scale, median
  double given_correlation = 0;  // as they are given
  bool is_clear = false;         // beyond doubt, else only likely
};

// `images`: CV_8UC1 of one size, by the frames of the tracks' pixels.
std::optional<TrackScale> FindOtherTrackScale(std::span<const PixelTrack> tracks, const std::map<int, cv::Mat>& images);

}  // namespace pliant
