// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Frames as a command line names them.
#pragma once

#include <string_view>
#include <vector>

#include "pliant/base/status.h"

namespace pliant::cli {

// The value of `option`, "10,20,30-35": numbers and ranges, both ends included, with commas between them. Empty text is
// no frame. Fails with kInvalidArgument where it is anything else.
Result<std::vector<int>> ParseFrameList(std::string_view option, std::string_view text);

}  // namespace pliant::cli
