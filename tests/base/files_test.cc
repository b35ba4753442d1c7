// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/base/files.h"

#include <string>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include "support/temporary_folder.h"

namespace pliant {
namespace {

// Leaves so many file descriptors, as long as it lives.
class DescriptorsLeft {
 public:
  explicit DescriptorsLeft(int left) {
    getrlimit(RLIMIT_NOFILE, &before_);
    const rlimit few = {static_cast<rlim_t>(64), before_.rlim_max};
    setrlimit(RLIMIT_NOFILE, &few);
    for (int fd = open("/dev/null", O_RDONLY); fd >= 0; fd = open("/dev/null", O_RDONLY)) taken_.push_back(fd);
    for (; left > 0 && !taken_.empty(); --left, taken_.pop_back()) close(taken_.back());
  }
  ~DescriptorsLeft() {
    for (const int fd : taken_) close(fd);
    setrlimit(RLIMIT_NOFILE, &before_);
  }
  DescriptorsLeft(const DescriptorsLeft&) = delete;
  DescriptorsLeft& operator=(const DescriptorsLeft&) = delete;

 private:
  rlimit before_ = {};
  std::vector<int> taken_;
};

TEST(Files, AreReadWithTheLastFileDescriptorAndNotWithoutOne) {
  const TemporaryFolder folder("files");
  const std::string path = folder.Path("file");
  ASSERT_TRUE(WriteFileAtomically(path, "content").ok());
  {
    const DescriptorsLeft one(1);
    const auto text = ReadFile(path);
    ASSERT_TRUE(text.ok()) << text.status().message();
    EXPECT_EQ(*text, "content");
  }
  const DescriptorsLeft none(0);
  const auto text = ReadFile(path);
  ASSERT_FALSE(text.ok());
  EXPECT_EQ(text.status().code(), ErrorCode::kUnreadable);
}

}  // namespace
}  // namespace pliant
