// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The refinement of a run, for the commands that do that.
#pragma once

#include <string>

#include "cli/command_line.h"
#include "pliant/pipeline/refine_run.h"

namespace pliant::cli {

// Refines, with a progress bar, and says what became of it. `stop` of the request is set by Ctrl-C. Gives the exit
// code.
int RefineAndSay(const RefineRequest& request, const RefineOptions& options);

}  // namespace pliant::cli
