// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/standard_input.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <span>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

namespace pliant {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kPollMs = 50;  // how late a stop is seen
constexpr std::size_t kBufferBytes = 1 << 16;

enum class Ready { kYes, kNotYet, kNever };

Ready Wait(int descriptor, short events) {
  pollfd polled = {descriptor, events, 0};
  const int count = poll(&polled, 1, kPollMs);
  if (count < 0) return errno == EINTR ? Ready::kNotYet : Ready::kNever;
  if (count == 0) return Ready::kNotYet;
  return (polled.revents & POLLNVAL) != 0 ? Ready::kNever : Ready::kYes;
}

}  // namespace

Result<std::unique_ptr<StandardInput>> StandardInput::Open(double timeout_s, std::function<bool()> is_stopped) {
  if (isatty(STDIN_FILENO) == 1)
    return Status(ErrorCode::kUnreadable,
                  "standard input is a terminal; pipe a video into the program, as in ffmpeg -i VIDEO -f yuv4mpegpipe "
                  "- | pliant track -");
  if (fcntl(STDIN_FILENO, F_GETFD) == -1)
    return Status(ErrorCode::kUnreadable, "standard input is closed; pipe a video into the program");
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0)
    return Status(ErrorCode::kUnreadable, "no pipe could be made for standard input; close other programs");
  std::unique_ptr<StandardInput> input(new StandardInput);
  input->read_end_ = ends[0];
  input->write_end_ = ends[1];
  fcntl(ends[1], F_SETFL, O_NONBLOCK);
  input->thread_ = std::thread([self = input.get(), timeout_s, is_stopped = std::move(is_stopped)] {
    self->PassOn(timeout_s, [&] { return self->is_closing_ || is_stopped(); });
    close(self->write_end_);
  });
  return input;
}

StandardInput::~StandardInput() {
  is_closing_ = true;
  if (thread_.joinable()) thread_.join();
  if (read_end_ >= 0) close(read_end_);
}

void StandardInput::PassOn(double timeout_s, const std::function<bool()>& is_stopped) {
  std::vector<unsigned char> buffer(kBufferBytes);
  Clock::time_point last = Clock::now();
  while (!is_stopped()) {
    const Ready readable = Wait(STDIN_FILENO, POLLIN);
    if (readable == Ready::kNever) return;
    if (readable == Ready::kNotYet) {
      has_stalled_ = std::chrono::duration<double>(Clock::now() - last).count() > timeout_s;
      if (has_stalled_) return;
      continue;
    }
    const ssize_t count = read(STDIN_FILENO, buffer.data(), buffer.size());
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count <= 0) return;
    std::span<const unsigned char> rest(buffer.data(), static_cast<std::size_t>(count));
    rest = rest.first(jpeg_sizes_.BytesBeforeChange(rest));
    while (!rest.empty()) {
      if (is_stopped()) return;
      if (Wait(write_end_, POLLOUT) == Ready::kNotYet) continue;
      const ssize_t written = write(write_end_, rest.data(), rest.size());
      if (written < 0 && errno != EINTR && errno != EAGAIN) return;
      if (written > 0) rest = rest.subspan(static_cast<std::size_t>(written));
    }
    has_changed_size_ = jpeg_sizes_.change().has_value();
    if (has_changed_size_) return;
    last = Clock::now();  // time in which the decoder did not read is not the sender's
  }
}

}  // namespace pliant
