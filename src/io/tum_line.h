// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Reading one line of a TUM trajectory, of whole files and of those that grow.
#pragma once

#include <string>
#include <string_view>

#include "pliant/io/trajectory.h"

namespace pliant {

// The sentence of a failure has no file and line; its caller knows them.
Result<TimedPose> ParseTumLine(std::string_view line);

// What a last line without a line end is: cut off (of a run that was killed), or as good as the others.
enum class OpenLastLine { kIsRead, kIsCut };

Result<std::vector<TimedPose>> ReadTumTrajectory(const std::string& path, OpenLastLine open_last_line, int* cut_lines);

}  // namespace pliant
