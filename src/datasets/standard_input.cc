// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/standard_input.h"

#include <cerrno>
#include <chrono>
#include <cstddef>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include "datasets/stream_errors.h"

namespace pliant {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kPollMs = 50;  // how late a stop is seen
constexpr std::size_t kBufferBytes = 1 << 16;

}  // namespace

StandardInput::StandardInput(double timeout_s) : timeout_s_(timeout_s), buffer_(kBufferBytes) {}

Result<std::unique_ptr<StandardInput>> StandardInput::Open(double timeout_s) {
  if (isatty(STDIN_FILENO) == 1)
    return Status(ErrorCode::kUnreadable,
                  "standard input is a terminal; pipe a video into the program, as in ffmpeg -i VIDEO -f yuv4mpegpipe "
                  "- | pliant track -");
  if (fcntl(STDIN_FILENO, F_GETFD) == -1) return StandardInputIsEmpty();
  return std::unique_ptr<StandardInput>(new StandardInput(timeout_s));
}

// Time in which nobody reads is not the sender's.
std::span<const unsigned char> StandardInput::Read(const std::function<bool()>& is_stopped) {
  const Clock::time_point begin = Clock::now();
  while (!is_stopped()) {
    pollfd polled = {STDIN_FILENO, POLLIN, 0};
    const int ready = poll(&polled, 1, kPollMs);
    if (ready < 0 && errno != EINTR) return {};
    if (ready > 0) {
      const ssize_t count = read(STDIN_FILENO, buffer_.data(), buffer_.size());
      if (count >= 0) return std::span(buffer_).first(static_cast<std::size_t>(count));
      if (errno != EINTR && errno != EAGAIN) return {};
    }
    has_stalled_ = std::chrono::duration<double>(Clock::now() - begin).count() > timeout_s_;
    if (has_stalled_) return {};
  }
  return {};
}

}  // namespace pliant
