// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstdlib>

#include "fuzz_input.h"
#include "pliant/io/track_file.h"

using namespace pliant;  // NOLINT(google-build-using-namespace): a file that is one function

// CSV, NumPy's arrays and archives, and COLMAP's databases are told apart by what they contain.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = ReadTrackFile(WriteFuzzFile("tracks", {data, size}));
  if (!file.ok()) {
    if (file.status().message().empty()) std::abort();
    return 0;
  }
  PointId last;
  bool seen = false;
  for (const PixelTrack& track : file->tracks) {
    if (!(last < track.id) || track.pixels.empty()) std::abort();
    last = track.id;
    int last_frame_idx = -1;
    for (const TrackPixel& pixel : track.pixels) {
      if (pixel.frame_idx <= last_frame_idx || !pixel.pixel.allFinite() || !(pixel.sigma_px >= 0)) std::abort();
      if (file->frames && pixel.frame_idx >= *file->frames) std::abort();
      last_frame_idx = pixel.frame_idx;
      seen = seen || pixel.visible;
    }
  }
  if (!seen) std::abort();
  return 0;
}
