// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/ticks.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pliant {
namespace {

using testing::ElementsAre;

std::vector<std::string> Labels(const std::vector<Tick>& ticks) {
  std::vector<std::string> labels;
  for (const Tick& tick : ticks) labels.push_back(tick.label);
  return labels;
}

TEST(Ticks, AreMultiplesOfOneTwoOrFive) {
  EXPECT_THAT(Labels(LinearTicks(0, 59, 7)), ElementsAre("0", "10", "20", "30", "40", "50"));
  EXPECT_THAT(Labels(LinearTicks(0, 1.49, 5)), ElementsAre("0.0", "0.5", "1.0"));
  EXPECT_THAT(Labels(LinearTicks(0, 340, 4)), ElementsAre("0", "100", "200", "300"));
  EXPECT_THAT(Labels(LinearTicks(-0.3, 0.3, 5)), ElementsAre("-0.2", "0.0", "0.2"));
  EXPECT_THAT(Labels(LinearTicks(0, 2e-5, 3)), ElementsAre("0.00000", "0.00001", "0.00002"));
}

TEST(Ticks, IncludeTheEndsOfTheirAxis) {
  EXPECT_THAT(Labels(LinearTicks(0, 0.3, 4)), ElementsAre("0.0", "0.1", "0.2", "0.3"));
  EXPECT_THAT(Labels(LinearTicks(100, 103, 4)), ElementsAre("100", "101", "102", "103"));
  EXPECT_THAT(Labels(LogarithmicTicks(0.01, 0.1, 4)), ElementsAre("0.01", "0.02", "0.05", "0.1"));
}

TEST(Ticks, AreNeverMoreThanFit) {
  for (double high = 0.0013; high < 1e6; high *= 1.37) {
    for (int max_count = 3; max_count < 9; ++max_count) {
      const auto linear = LinearTicks(0, high, max_count);
      EXPECT_LE(linear.size(), max_count);
      EXPECT_GE(linear.size(), 2) << high;  // 0 is one of them
      const auto logarithmic = LogarithmicTicks(high / 1e4, high, max_count);
      EXPECT_LE(logarithmic.size(), max_count);
      EXPECT_GE(logarithmic.size(), 1) << high;
    }
  }
}

TEST(Ticks, OfALogarithmicAxisArePowersOfTenWhereItIsLong) {
  EXPECT_THAT(Labels(LogarithmicTicks(0.4, 20, 6)), ElementsAre("0.5", "1", "2", "5", "10", "20"));
  EXPECT_THAT(Labels(LogarithmicTicks(0.4, 20, 5)), ElementsAre("1", "10"));
  EXPECT_THAT(Labels(LogarithmicTicks(0.02, 150, 6)), ElementsAre("0.1", "1", "10", "100"));
  EXPECT_THAT(Labels(LogarithmicTicks(0.0007, 150, 3)), ElementsAre("0.01", "1", "100"));
}

}  // namespace
}  // namespace pliant
