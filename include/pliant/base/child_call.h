// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Calls into parsers of other projects, in a process of their own: one that crashes, does not end or asks for too much
// memory ends that process, and not the program.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "pliant/base/status.h"

namespace pliant {

struct ChildLimits {
  int cpu_seconds = 10;             // at least 1; five times as long by the clock
  std::int64_t memory_bytes = 1e9;  // of addresses, beyond those that the program has already
};

// What `call` returns in a child process (fork): it sees the program's memory as it is, what it changes there is lost,
// and it must not wait for other threads, which its process does not have. Where the child does not live to answer, or
// there can be none, kUnreadable: `what`, ": " and why ("its reader was ended by signal 11"). The child ends with the
// thread that calls.
Result<std::string> CallInChild(const std::string& what, const ChildLimits& limits,
                                const std::function<Result<std::string>()>& call);

}  // namespace pliant
