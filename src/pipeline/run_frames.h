// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The frames of a run that is to be worked on further.
#pragma once

#include <string>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/io/run_reader.h"

namespace pliant {

// The frame of every pose of `run`, which was read from `path`. Fails with kMismatch for another program's result,
// whose poses belong to no frame.
Result<std::vector<int>> FramesWithPose(const std::string& path, const Run& run);

}  // namespace pliant
