// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The bytes of standard input, for which nobody waits without end.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "pliant/base/status.h"

namespace pliant {

class StandardInput {
 public:
  // Fails with kUnreadable: a terminal, or closed.
  static Result<std::unique_ptr<StandardInput>> Open(double timeout_s);

  // The next bytes, which stay until the next call; none at the end, when nothing has come for the time-out, and when
  // `is_stopped` says so. To be called by one thread at a time.
  std::span<const unsigned char> Read(const std::function<bool()>& is_stopped);
  // Whether Read has waited in vain.
  bool has_stalled() const { return has_stalled_; }

 private:
  explicit StandardInput(double timeout_s);

  double timeout_s_;
  std::vector<unsigned char> buffer_;
  std::atomic<bool> has_stalled_ = false;
};

}  // namespace pliant
