// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Point tracks in files, told apart by their content (docs/formats.md):
//   CSV       frame,track_id,u_px,v_px and optional sigma_px, in any order of columns; a row is a point that is seen
//   .npz      tracks (T, N, 2), visibility (T, N), optional sigma_px (T, N); a first axis of length 1 may precede them
//   .npy      tracks alone, all of them seen
//   COLMAP    a database: keypoints joined by the matches that its geometric verification left
// Pixels are those of the file; only a database says where its first pixel's center is.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/scene/pixel_track.h"

namespace pliant {

struct TrackFileImage {
  std::string name;
  std::uint64_t width = 0;
  std::uint64_t height = 0;
};

struct TrackFile {
  std::vector<PixelTrack> tracks;  // sorted by id, from 0 to 2^31 - 1; in arrays the place on the axis of points
  std::optional<int> frames;       // arrays: the length of the axis of time, whose place is the frame; else nothing
  // A database: its images; a frame_idx is a place in this list, and pixels have (0, 0) at the center of the first one.
  std::vector<TrackFileImage> images;
  std::vector<std::string> notes;  // what is odd about it, and was read all the same; a sentence each
};

// Fails with kNotFound; kUnreadable (no such file, damaged or cut off, arrays of another shape, type or order, numbers
// that are not finite where a point is seen, a track that comes twice in a frame); kInsufficient where no point is
// seen.
Result<TrackFile> ReadTrackFile(const std::string& path);

// The rows of the visible pixels, by frame and id, with four decimals; sigma_px is written where one is known. Fails
// with kUnwritable.
Status WriteTrackCsv(const std::string& path, std::span<const PixelTrack> tracks);

// Arrays of single precision over the frames 0 to `frames` - 1, and track_id (N), the points' ids in the order of the
// axis; pixels of frames that a track does not have are not numbers, and not visible. Fails with kUnwritable, and with
// kInvalidArgument where the file would be larger than 4 GB.
Status WriteTrackNpz(const std::string& path, std::span<const PixelTrack> tracks, int frames);

}  // namespace pliant
