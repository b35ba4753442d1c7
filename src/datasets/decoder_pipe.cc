// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/decoder_pipe.h"

#include <array>
#include <cerrno>
#include <cstddef>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace pliant {
namespace {

constexpr int kPollMs = 50;  // how late a stop is seen
constexpr unsigned char kBeginOfY4m = 'Y';

}  // namespace

Result<std::unique_ptr<DecoderPipe>> DecoderPipe::Open(StandardInput* input, std::span<const unsigned char> begin,
                                                       std::function<bool()> is_stopped) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0)
    return Status(ErrorCode::kUnreadable, "no pipe could be made for standard input; close other programs");
  std::unique_ptr<DecoderPipe> pipe(new DecoderPipe);
  pipe->read_end_ = ends[0];
  pipe->write_end_ = ends[1];
  fcntl(ends[1], F_SETFL, O_NONBLOCK);
  if (!begin.empty() && begin.front() == kBeginOfY4m) pipe->y4m_.emplace("-");
  pipe->thread_ = std::thread(
      [self = pipe.get(), input, first = std::vector(begin.begin(), begin.end()), is_stopped = std::move(is_stopped)] {
        self->PassOn(input, first, [&] { return self->is_closing_ || is_stopped(); });
        self->has_ended_ = true;
        close(self->write_end_);
      });
  return pipe;
}

DecoderPipe::~DecoderPipe() {
  is_closing_ = true;
  if (thread_.joinable()) thread_.join();
  if (read_end_ >= 0) close(read_end_);
}

bool DecoderPipe::HasMore() const {
  int unread = 0;
  return !has_ended_ || (ioctl(read_end_, FIONREAD, &unread) == 0 && unread > 0);
}

void DecoderPipe::PassOn(StandardInput* input, const std::vector<unsigned char>& begin,
                         const std::function<bool()>& is_stopped) {
  std::span<const unsigned char> bytes = begin;
  while (!bytes.empty() && status_.ok() && !is_stopped()) {
    if (y4m_) {
      status_ = y4m_->Add(bytes);
      if (!Write(y4m_->TakeWhole(), is_stopped)) return;
    } else if (!Write(bytes, is_stopped)) {
      return;
    }
    if (status_.ok()) bytes = input->Read(is_stopped);
  }
}

bool DecoderPipe::Write(std::span<const unsigned char> bytes, const std::function<bool()>& is_stopped) const {
  while (!bytes.empty()) {
    if (is_stopped()) return false;
    pollfd polled = {write_end_, POLLOUT, 0};
    const int ready = poll(&polled, 1, kPollMs);
    if (ready < 0 && errno != EINTR) return false;
    if (ready <= 0) continue;
    const ssize_t written = write(write_end_, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR && errno != EAGAIN) return false;
    if (written > 0) bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace pliant
