// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The refinement of a run, for the commands that do that.
#pragma once

#include <string>

#include "cli/command_line.h"
#include "pliant/pipeline/refine_run.h"

namespace pliant::cli {

enum class Saying { kAll, kErrors };

// Refines, with a progress bar, and says what became of it, unless only errors are to be said. `stop` of the request is
// set by Ctrl-C. Gives the exit code.
int RefineAndSay(std::string_view command, const RefineRequest& request, const RefineOptions& options, Saying saying);

}  // namespace pliant::cli
