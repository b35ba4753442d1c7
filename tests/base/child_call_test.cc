// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/base/child_call.h"

#include <atomic>
#include <csignal>
#include <stdexcept>
#include <string>
#include <vector>

#include <unistd.h>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pliant {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr auto kWhat = "the file f cannot be read";

TEST(CallInChild, ReturnsWhatTheCallReturnsAndChangesNothing) {
  int changed = 0;
  const auto big = CallInChild(kWhat, {}, [&]() -> Result<std::string> {
    changed = 1;
    return std::string(3000000, 'x') + std::string(1, '\0') + "end";
  });
  ASSERT_TRUE(big.ok());
  EXPECT_EQ(*big, std::string(3000000, 'x') + std::string(1, '\0') + "end");
  EXPECT_EQ(changed, 0);
  const auto nothing = CallInChild(kWhat, {}, []() -> Result<std::string> { return std::string(); });
  ASSERT_TRUE(nothing.ok());
  EXPECT_EQ(*nothing, "");
}

TEST(CallInChild, ReturnsTheFailureOfTheCall) {
  const auto failed = CallInChild(kWhat, {}, []() -> Result<std::string> {
    return {ErrorCode::kNotFound, "there is no face"};
  });
  ASSERT_FALSE(failed.ok());
  EXPECT_EQ(failed.status().code(), ErrorCode::kNotFound);
  EXPECT_EQ(failed.status().message(), "there is no face");
  const auto thrown = CallInChild(kWhat, {}, []() -> Result<std::string> { throw std::runtime_error("bad vertex"); });
  EXPECT_EQ(thrown.status().message(), "the file f cannot be read: bad vertex");
}

TEST(CallInChild, OutlivesACrash) {
  const auto failed = CallInChild(kWhat, {}, []() -> Result<std::string> {
    raise(SIGKILL);
    return std::string();
  });
  ASSERT_FALSE(failed.ok());
  EXPECT_EQ(failed.status().code(), ErrorCode::kUnreadable);
  EXPECT_EQ(failed.status().message(), "the file f cannot be read: its reader was ended by signal 9");
  const auto silent = CallInChild(kWhat, {}, []() -> Result<std::string> { _exit(0); });
  EXPECT_THAT(silent.status().message(), HasSubstr("its reader did not answer"));
}

TEST(CallInChild, EndsACallThatDoesNotEnd) {
  const auto failed = CallInChild(kWhat, {.cpu_seconds = 1}, []() -> Result<std::string> {
    for (std::atomic<int> steps = 0;; ++steps) {
    }
  });
  EXPECT_THAT(failed.status().message(), HasSubstr("its reader needs more than 1 s"));
}

TEST(CallInChild, EndsACallThatWaits) {
  const auto failed = CallInChild(kWhat, {.cpu_seconds = 1}, []() -> Result<std::string> {
    for (;;) pause();
  });
  EXPECT_THAT(failed.status().message(), HasSubstr("its reader needs more than 1 s"));
}

TEST(CallInChild, EndsACallThatWantsTooMuchMemory) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "addresses are not limited under the address sanitizer";
#endif
  const auto failed = CallInChild(kWhat, {.memory_bytes = 100000000}, []() -> Result<std::string> {
    std::vector<std::string> parts;
    for (int k = 0; k < 1000; ++k) parts.emplace_back(1000000, static_cast<char>(k));
    return parts.back();
  });
  ASSERT_FALSE(failed.ok());
  EXPECT_THAT(failed.status().message(), StartsWith("the file f cannot be read: its reader "));
}

}  // namespace
}  // namespace pliant
