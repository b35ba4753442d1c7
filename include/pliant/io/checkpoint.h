// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What a run needs to be resumed: RUN/checkpoint/state, written every Nth frame while the run lasts and deleted at its
// end. A run that is stopped keeps it, and beside it its rows as they were written (Finish may have moved some into
// other worlds). The state is that of the program's memory: for the same version of the program alone, built with the
// same compiler and libraries for the same machine.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "pliant/base/status.h"
#include "pliant/io/run_summary.h"

namespace pliant {

// Replaces the checkpoint of a run; whatever happens, even to the power, the old one or the new one is there whole.
// Fails with kUnwritable.
Status WriteCheckpoint(const std::string& run_path, std::string_view state);
// The state. Fails with kNotFound where there is no checkpoint, with kUnreadable for one that is damaged and with
// kMismatch for one of another version or build.
Result<std::string> ReadCheckpoint(const std::string& run_path);
bool HasCheckpoint(const std::string& run_path);
// Of a run that has ended: there is no checkpoint any more, nor what belongs to one.
void ForgetCheckpoint(const std::string& run_path);

// Of a run that has come to its end, so that there is nothing to resume; nothing: there is none.
std::optional<RunSummary> EndedRun(const std::string& run_path);

}  // namespace pliant
