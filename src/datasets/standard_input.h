// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Standard input for a decoder that waits for it without end: what comes is passed on through a pipe of our own, which
// is closed when nothing more is to be waited for.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <thread>

#include "datasets/jpeg_sizes.h"
#include "pliant/base/status.h"

namespace pliant {

class StandardInput {
 public:
  // The pipe ends with standard input, when nothing has come for `timeout_s`, before a JPEG image of another size, or
  // when `is_stopped` (asked from another thread) says so. Fails with kUnreadable: a terminal, or closed.
  static Result<std::unique_ptr<StandardInput>> Open(double timeout_s, std::function<bool()> is_stopped);
  ~StandardInput();
  StandardInput(const StandardInput&) = delete;
  StandardInput& operator=(const StandardInput&) = delete;

  int descriptor() const { return read_end_; }
  // Whether the pipe has ended since nothing came.
  bool has_stalled() const { return has_stalled_; }
  // The change of size before which the pipe has ended.
  std::optional<JpegSizes::Change> size_change() const {
    return has_changed_size_ ? jpeg_sizes_.change() : std::nullopt;
  }

 private:
  StandardInput() = default;
  void PassOn(double timeout_s, const std::function<bool()>& is_stopped);

  int read_end_ = -1;
  int write_end_ = -1;
  JpegSizes jpeg_sizes_;  // of the thread, until the last of these is set
  std::atomic<bool> is_closing_ = false, has_stalled_ = false, has_changed_size_ = false;
  std::thread thread_;
};

}  // namespace pliant
