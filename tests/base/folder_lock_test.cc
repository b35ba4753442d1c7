// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/base/folder_lock.h"

#include <filesystem>
#include <optional>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/temporary_folder.h"

namespace pliant {
namespace {

using testing::HasSubstr;

TEST(FolderLock, IsHeldByOneAtATime) {
  const TemporaryFolder folder("folder_lock");
  auto first = FolderLock::Take(folder.Path(""));
  ASSERT_TRUE(first.ok()) << first.status().message();
  const auto second = FolderLock::Take(folder.Path(""));
  ASSERT_FALSE(second.ok());
  EXPECT_EQ(second.status().code(), ErrorCode::kUnwritable);
  EXPECT_THAT(second.status().message(), HasSubstr("another program is writing into"));
  std::optional<FolderLock> moved = *std::move(first);
  EXPECT_FALSE(FolderLock::Take(folder.Path("")).ok());
  moved.reset();
  EXPECT_TRUE(FolderLock::Take(folder.Path("")).ok());
  EXPECT_TRUE(std::filesystem::is_empty(folder.Path("")));
}

TEST(FolderLock, EndsWithItsProcess) {
  const TemporaryFolder folder("folder_lock_of_process");
  const pid_t child = fork();
  if (child == 0) {
    const auto lock = FolderLock::Take(folder.Path(""));
    _exit(lock.ok() && !FolderLock::Take(folder.Path("")).ok() ? 0 : 1);  // no destructor runs
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  EXPECT_TRUE(FolderLock::Take(folder.Path("")).ok());
}

TEST(FolderLock, OfNoFolderIsRefused) {
  const TemporaryFolder folder("folder_lock_of_none");
  EXPECT_THAT(FolderLock::Take(folder.Path("none")).status().message(), HasSubstr("cannot open the folder"));
}

}  // namespace
}  // namespace pliant
