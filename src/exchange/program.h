// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Another program, run to its end.
#pragma once

#include <string>
#include <vector>

#include "pliant/base/status.h"

namespace pliant {

// Runs `arguments[0]`, found on PATH, without a shell, and appends what it prints to the file `log_path`. Fails with
// kNotFound if there is no such program, with kUnwritable for the log, with kUnreadable if it does not end with 0: the
// sentence has the last line that it printed, and the path of the log.
Status RunProgram(const std::vector<std::string>& arguments, const std::string& log_path);

}  // namespace pliant
