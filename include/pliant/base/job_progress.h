// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How far a job is that goes through frames and writes at its end.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "pliant/base/status.h"

namespace pliant {

// Called when `done` of `total` frames (0: not known) are through `task` ("evaluate", "images"), of which a job may
// have several, one after the other. False asks to stop: the job then fails with kInterrupted and leaves what was there
// before.
using JobProgress = std::function<bool(std::string_view task, int done, int total)>;

// Says it to `progress`, which may be empty. kInterrupted where that asks to stop.
inline Status Tell(const JobProgress& progress, std::string_view task, int done, int total) {
  if (!progress || progress(task, done, total)) return Status::Ok();
  return {ErrorCode::kInterrupted, "stopped on request; nothing was written"};
}

}  // namespace pliant
