// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The forms of a file of tracks that are not text.
#pragma once

#include <string>
#include <string_view>

#include "pliant/base/status.h"
#include "pliant/io/track_file.h"

namespace pliant {

// NumPy's .npy or .npz. Fails as ReadTrackFile.
Result<TrackFile> ReadTrackArrays(const std::string& path, std::string_view bytes);

// COLMAP's database. A connected set of keypoints is a track; one with two keypoints in an image is none, and counted
// in a note. Fails as ReadTrackFile.
Result<TrackFile> ReadTrackDatabase(const std::string& path);

}  // namespace pliant
