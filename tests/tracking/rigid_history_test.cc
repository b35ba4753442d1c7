// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/submap/rigid_history.h"

#include <vector>

#include <gmock/gmock.h>

namespace pliant {
namespace {

constexpr std::size_t kMaxFrames = 64;  // what the history holds
constexpr std::size_t kMinFrames = 30;  // every second one goes when it is full
constexpr int kMinAttempts = 10;        // each when there is a fifth more: 990 frames are 25 times as many as 40
constexpr int kMaxAttempts = 40;

std::vector<InitFrame> Frames(int count) {
  std::vector<InitFrame> frames;
  for (int t = 0; t < count; ++t) frames.push_back({t, {}});
  return frames;
}

TEST(RigidHistory, IsDueWhenTheFramesHaveBecomeMoreByAShare) {
  RigidHistory history;
  history.Start(Frames(20));
  std::vector<int> due;
  for (int t = 20; t < 40; ++t)
    if (history.Add({t, {}})) due.push_back(t);
  EXPECT_THAT(due, testing::ElementsAre(22, 26, 31, 36));  // with 23, 27, 32 and 37 frames
}

TEST(RigidHistory, OfALongOneFramesAreLeftOutEvenly) {
  for (const int first_map : {11, 61, 90}) {
    RigidHistory history;
    history.Start(Frames(first_map));
    int attempts = 0;
    for (int t = first_map; t < 1000; ++t) {
      const bool due = history.Add({t, {}});
      ASSERT_LE(history.frames().size(), kMaxFrames);
      ASSERT_EQ(history.frames().front().frame_idx, 0);  // the reference
      if (!due) continue;
      ++attempts;
      ASSERT_EQ(history.frames().back().frame_idx, t);
      const int step = history.frames()[1].frame_idx;
      for (std::size_t k = 0; k < history.frames().size(); ++k)
        ASSERT_EQ(history.frames()[k].frame_idx, static_cast<int>(k) * step);
    }
    EXPECT_GT(history.frames().size(), kMinFrames);
    EXPECT_GT(attempts, kMinAttempts);
    EXPECT_LT(attempts, kMaxAttempts);
  }
}

TEST(RigidHistory, ThatWasStoppedStaysEmpty) {
  RigidHistory history;
  EXPECT_FALSE(history.Add({0, {}}));
  history.Start(Frames(11));
  history.Stop();
  for (int t = 11; t < 100; ++t) EXPECT_FALSE(history.Add({t, {}}));
  EXPECT_TRUE(history.empty());
}

}  // namespace
}  // namespace pliant
