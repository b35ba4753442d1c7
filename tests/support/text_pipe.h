// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A named pipe that holds a text. Its other end is open as long as it is there, so that nothing that opens it waits,
// and what reads it waits only behind the text.
#pragma once

#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace pliant {

class TextPipe {
 public:
  TextPipe(const std::string& path, const std::string& text) : size_(static_cast<int>(text.size())) {
    EXPECT_EQ(mkfifo(path.c_str(), 0600), 0);
    descriptor_ = open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    EXPECT_EQ(write(descriptor_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  ~TextPipe() { close(descriptor_); }
  TextPipe(const TextPipe&) = delete;
  TextPipe& operator=(const TextPipe&) = delete;

  // Whether it still holds the whole text.
  bool IsUnread() const {
    int bytes = -1;
    return ioctl(descriptor_, FIONREAD, &bytes) == 0 && bytes == size_;
  }

 private:
  int size_ = 0;
  int descriptor_ = -1;
};

}  // namespace pliant
