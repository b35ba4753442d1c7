// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Frames as a command line names them.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace pliant::cli {

// "10,20,30-35": numbers and ranges, both ends included, with commas between them; nothing where it is anything else.
// Empty text is no frame.
std::optional<std::vector<int>> ParseFrameList(std::string_view text);

}  // namespace pliant::cli
