// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Run folders against the truth of their sequences, for the commands that do that.
#pragma once

#include <string>

#include "cli/command_line.h"

namespace pliant::cli {

// --protocol, --scale, --parts, --camera.
void AddEvaluationArguments(CommandLine* line, std::string* camera_path);

}  // namespace pliant::cli
