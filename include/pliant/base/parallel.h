// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// One loop over independent items on a limited number of threads.
#pragma once

#include <functional>

namespace pliant {

// Items a task, for items of some microseconds each: to hand a task out takes about one.
inline constexpr int kManySmallItems = 16;

// Calls body(i) for every i in [0, count), on at most `threads` threads (at least 1; one thread runs in the caller),
// at least `grain` items at a time. A body writes only what belongs to its i, so the result does not depend on the
// number of threads.
void ParallelFor(int count, int threads, const std::function<void(int)>& body, int grain = kManySmallItems);

// The calling thread gets what the others of the machine leave.
void LowerThreadPriority();

}  // namespace pliant
