// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Ctrl-C, SIGTERM and a closed terminal ask a command to stop at the next frame, so that it can close its files.
#pragma once

#include <atomic>

namespace pliant::cli {

// From this call on the first SIGINT, SIGTERM or SIGHUP (unless it was ignored, as under nohup) sets the flag that is
// returned; a second one of its kind ends the process at once. A closed pipe on standard output or error ends nothing.
std::atomic<bool>& StopOnSignals();

// The signal that came last; 0: none has.
int LastSignal();

}  // namespace pliant::cli
