// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/base/prefetcher.h"

#include <atomic>
#include <memory>
#include <stdexcept>

#include <gtest/gtest.h>

namespace pliant {
namespace {

TEST(Prefetcher, GivesWhatPlainCallsGiveAndThenTheEnd) {
  for (const int ahead : {0, 1, 3}) {
    int count = 0;
    Prefetcher<std::unique_ptr<int>> prefetcher(
        [&]() -> std::optional<std::unique_ptr<int>> {
          if (count == 50) return std::nullopt;
          return std::make_unique<int>(count++);
        },
        ahead);
    for (int i = 0; i < 50; ++i) EXPECT_EQ(**prefetcher.Next(), i);
    EXPECT_FALSE(prefetcher.Next().has_value());
    EXPECT_FALSE(prefetcher.Next().has_value());
  }
}

TEST(Prefetcher, NeverRunsFurtherAheadThanAskedAndStopsAtAnyTime) {
  constexpr int kTaken = 2;
  constexpr int kAhead = 2;
  std::atomic<int> made = 0;
  {
    Prefetcher<int> prefetcher([&]() -> std::optional<int> { return made++; }, kAhead);
    EXPECT_EQ(*prefetcher.Next(), 0);
    EXPECT_EQ(*prefetcher.Next(), 1);
  }
  EXPECT_LE(made, kTaken + kAhead + 1);  // and one that is being made
}

TEST(Prefetcher, ThrowsInNextWhatTheProducerThrew) {
  for (const int ahead : {0, 2}) {
    int count = 0;
    Prefetcher<int> prefetcher(
        [&]() -> std::optional<int> {
          if (count == 3) throw std::runtime_error("torn tape");
          return count++;
        },
        ahead);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(*prefetcher.Next(), i);
    EXPECT_THROW((void)prefetcher.Next(), std::runtime_error);
  }
}

}  // namespace
}  // namespace pliant
