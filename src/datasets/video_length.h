// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the container of a video says of its length, where a decoder does not pass it on.
#pragma once

#include <filesystem>
#include <optional>

namespace pliant {

// Whether it says how many frames there are, as AVI and MP4 do; of others that is estimated. False for a file that
// cannot be read.
bool CountsFrames(const std::filesystem::path& file);

// For how long a file of MP4's family shows something, by its edit lists (ISO/IEC 14496-12, 8.6.6): one that was cut
// without being coded again counts frames that they hide. Nothing where it has no such list, or cannot be read.
std::optional<double> ShownSeconds(const std::filesystem::path& file);

}  // namespace pliant
