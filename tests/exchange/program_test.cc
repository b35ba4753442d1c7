// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "exchange/program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/test_folder.h"

namespace pliant {
namespace {

using testing::HasSubstr;

TEST(RunProgram, KeepsWhatItSaid) {
  const TestFolder folder;
  ASSERT_TRUE(RunProgram({"sh", "-c", "echo one; echo two >&2"}, folder.Path("log")).ok());
  EXPECT_EQ(folder.Read("log"), "one\ntwo\n");
}

TEST(RunProgram, ThatIsNotThereIsNotFound) {
  const TestFolder folder;
  const Status status = RunProgram({"no_such_program", "x"}, folder.Path("log"));
  EXPECT_EQ(status.code(), ErrorCode::kNotFound);
  EXPECT_THAT(status.message(), HasSubstr("'no_such_program'"));
}

TEST(RunProgram, ThatFailsSaysItsLastLine) {
  const TestFolder folder;
  const Status status = RunProgram({"sh", "-c", "echo first; echo 'the reason'; echo; exit 3"}, folder.Path("log"));
  EXPECT_EQ(status.code(), ErrorCode::kUnreadable);
  EXPECT_THAT(status.message(), HasSubstr("ended with 3: the reason"));
  EXPECT_THAT(status.message(), HasSubstr(folder.Path("log")));
  EXPECT_THAT(RunProgram({"sh", "-c", "kill -9 $$"}, folder.Path("log")).message(), HasSubstr("by signal 9"));
}

}  // namespace
}  // namespace pliant
