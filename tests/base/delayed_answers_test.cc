// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/base/delayed_answers.h"

#include <atomic>
#include <chrono>
#include <future>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace pliant {
namespace {

constexpr auto kSlow = std::chrono::milliseconds(20);

class DelayedAnswersIn : public testing::TestWithParam<WorkPlace> {};

TEST_P(DelayedAnswersIn, AreTakenAFixedNumberOfStepsLater) {
  DelayedAnswers<int> answers;
  std::vector<std::optional<int>> taken;
  for (int step = 0; step < 8; ++step) {
    if (step % 2 == 0)
      answers.Ask(step + 3, GetParam(), [step] {
        if (step == 2) std::this_thread::sleep_for(kSlow);
        return step;
      });
    taken.push_back(answers.Take(step));
  }
  const auto none = std::nullopt;
  EXPECT_EQ(taken, (std::vector<std::optional<int>>{none, none, none, 0, none, 2, none, 4}));
}

TEST_P(DelayedAnswersIn, ThatWereNotTakenInTimeAreTakenInTheirOrder) {
  DelayedAnswers<int> answers;
  for (int step = 0; step < 3; ++step) answers.Ask(step + 1, GetParam(), [step] { return step; });
  EXPECT_EQ(answers.Take(3), 0);
  EXPECT_EQ(answers.Take(3), 1);
  EXPECT_FALSE(answers.IsEmpty());
  EXPECT_EQ(answers.Take(3), 2);
  EXPECT_TRUE(answers.IsEmpty());
  EXPECT_EQ(answers.Take(3), std::nullopt);
}

TEST(DelayedAnswers, ThatAreLateAreTakenWhenTheyAreThere) {
  DelayedAnswers<int> answers;
  std::promise<void> goes_on;
  answers.Ask(1, WorkPlace::kBeside, [&] {
    goes_on.get_future().wait();
    return 1;
  });
  answers.Ask(2, WorkPlace::kBeside, [] { return 2; });
  EXPECT_EQ(answers.TakeIfThere(2), std::nullopt);
  EXPECT_EQ(answers.size(), 2U);
  goes_on.set_value();
  std::optional<int> first;
  while (!(first = answers.TakeIfThere(3))) std::this_thread::sleep_for(kSlow);
  EXPECT_EQ(first, 1);
  EXPECT_EQ(answers.TakeIfThere(1), std::nullopt);  // not due
  EXPECT_EQ(answers.Take(3), 2);
}

TEST_P(DelayedAnswersIn, AreNotTakenOnceDropped) {
  DelayedAnswers<int> answers;
  answers.Ask(1, GetParam(), [] { return 1; });
  answers.Drop();
  EXPECT_EQ(answers.Take(5), std::nullopt);
  answers.Ask(6, GetParam(), [] { return 2; });
  EXPECT_EQ(answers.Take(6), 2);
}

TEST_P(DelayedAnswersIn, PassOnWhatTheJobThrows) {
  DelayedAnswers<int> answers;
  answers.Ask(0, GetParam(), []() -> int { throw std::runtime_error("no memory"); });
  EXPECT_THROW(answers.Take(0), std::runtime_error);
}

INSTANTIATE_TEST_SUITE_P(Places, DelayedAnswersIn, testing::Values(WorkPlace::kHere, WorkPlace::kBeside));

TEST(DelayedAnswers, RunBesideTheLoop) {
  DelayedAnswers<int> answers;
  std::atomic<bool> may_end = false;
  answers.Ask(1, WorkPlace::kBeside, [&] {
    while (!may_end) std::this_thread::yield();
    return 7;
  });
  EXPECT_EQ(answers.Take(0), std::nullopt) << "it would wait for ever";
  may_end = true;
  EXPECT_EQ(answers.Take(1), 7);
}

TEST(DelayedAnswers, EndAfterTheJobThatRunsAndWithoutThoseThatWait) {
  std::atomic<int> begun = 0;
  std::atomic<int> ended = 0;
  {
    DelayedAnswers<int> answers;
    for (int job = 0; job < 3; ++job)
      answers.Ask(job, WorkPlace::kBeside, [&] {
        ++begun;
        std::this_thread::sleep_for(kSlow);
        return ++ended;
      });
    while (begun == 0) std::this_thread::yield();
  }
  EXPECT_EQ(begun, 1);
  EXPECT_EQ(ended, 1);
}

}  // namespace
}  // namespace pliant
