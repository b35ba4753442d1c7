// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Standard input as the end of a pipe, into which a test writes a video as raw gray images (YUV4MPEG2).
#pragma once

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <string>
#include <string_view>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <poll.h>
#include <unistd.h>

namespace pliant {

class PipedVideo {
 public:
  PipedVideo() : before_(fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0)) {
    std::signal(SIGPIPE, SIG_IGN);
    std::array<int, 2> ends{};
    EXPECT_EQ(pipe2(ends.data(), O_CLOEXEC), 0);
    EXPECT_EQ(dup2(ends[0], STDIN_FILENO), STDIN_FILENO);
    close(ends[0]);
    end_ = ends[1];
    fcntl(end_, F_SETFL, O_NONBLOCK);
  }
  ~PipedVideo() {
    Close();
    if (before_ >= 0) dup2(before_, STDIN_FILENO);
    if (before_ >= 0) close(before_);
  }
  PipedVideo(const PipedVideo&) = delete;
  PipedVideo& operator=(const PipedVideo&) = delete;

  // Waits until it is read, or GiveUp.
  void Write(std::string_view bytes) const {
    while (!bytes.empty() && !gives_up_) {
      pollfd writable = {end_, POLLOUT, 0};
      if (poll(&writable, 1, 20) == 0) continue;
      const ssize_t written = write(end_, bytes.data(), bytes.size());
      if (written < 0 && errno != EAGAIN) return;
      if (written > 0) bytes.remove_prefix(static_cast<std::size_t>(written));
    }
  }
  // From another thread: nobody will read the rest.
  void GiveUp() { gives_up_ = true; }
  void Header(int width, int height, int fps) const {
    Write("YUV4MPEG2 W" + std::to_string(width) + " H" + std::to_string(height) + " F" + std::to_string(fps) +
          ":1 Ip A1:1 C420jpeg\n");
  }
  // 8-bit, one channel, even sides.
  void Image(const cv::Mat& gray) const {
    std::string bytes = "FRAME\n";
    for (int y = 0; y < gray.rows; ++y) bytes.append(gray.ptr<char>(y), static_cast<std::size_t>(gray.cols));
    bytes.append(gray.total() / 2, '\x80');  // no color
    Write(bytes);
  }
  // The end of the video.
  void Close() {
    if (end_ >= 0) close(end_);
    end_ = -1;
  }

 private:
  int before_;
  int end_ = -1;
  std::atomic<bool> gives_up_ = false;
};

}  // namespace pliant
