// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Point tracks of another program for the images of a sequence: read, checked against the images, and brought to our
// pixels.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/scene/pixel_track.h"

namespace pliant {

// What lies at (0, 0) in a file of tracks.
enum class PixelOrigin {
  kCenter,  // the center of the first pixel: Pliant, OpenCV, CoTracker
  kCorner,  // its upper left corner, so that the center is (0.5, 0.5): raster coordinates, TAP-Vid, TAPIR
};
template <>
struct EnumNames<PixelOrigin> {
  static constexpr std::array kNames = {std::pair{PixelOrigin::kCenter, std::string_view("center")},
                                        std::pair{PixelOrigin::kCorner, std::string_view("corner")}};
};

struct TrackFileOptions {
  std::string path;  // empty: none
  PixelOrigin pixel_origin = PixelOrigin::kCenter;
  double max_sigma_px = 2;  // a pixel whose standard deviation is larger counts as not seen

  bool IsGiven() const { return !path.empty(); }
  void List(OptionTable& table);  // group "TrackFile"
};

struct SequenceTracks {
  std::vector<PixelTrack> tracks;  // by id; frames by the source's own numbers; the hidden pixels too
  std::vector<std::string> notes;  // what is odd, and was read all the same; a sentence each
};

// Of the whole source, whatever start, end and stride of the request are. A database's images belong to the frames that
// have their file names. Pixels outside the image are left out and noted. Fails as ReadTrackFile and OpenSequence, and
// with kMismatch where the file does not belong to these images: arrays of another number of frames, frames that the
// source does not have, images of another size (a database says it; else more than a twentieth of the pixels lies
// outside the image, all lie in its upper left quarter, or the first images that move agree along the tracks only when
// these are scaled; where this is likely alone, it is noted).
Result<SequenceTracks> ReadTracksOfSequence(const TrackFileOptions& options, const SequenceRequest& request);

}  // namespace pliant
