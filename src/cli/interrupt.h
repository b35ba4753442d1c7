// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Ctrl-C and SIGTERM ask a command to stop at the next frame, so that it can close its files.
#pragma once

#include <atomic>

namespace pliant::cli {

// From this call on the first SIGINT or SIGTERM sets the flag that is returned; a second one ends the process at once.
std::atomic<bool>& StopOnSignals();

}  // namespace pliant::cli
