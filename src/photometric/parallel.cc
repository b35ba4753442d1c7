// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/photometric/parallel.h"

#include <cassert>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace pliant {

void ParallelFor(int count, int threads, const std::function<void(int)>& body) {
  assert(threads >= 1);
  constexpr int kGrain = 16;  // items a task: some microseconds each, against about one to hand a task out
  if (threads == 1 || count <= kGrain) {
    for (int i = 0; i < count; ++i) body(i);
    return;
  }
  tbb::task_arena arena(threads);
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<int>(0, count, kGrain), [&](const tbb::blocked_range<int>& range) {
      for (int i = range.begin(); i < range.end(); ++i) body(i);
    });
  });
}

}  // namespace pliant
