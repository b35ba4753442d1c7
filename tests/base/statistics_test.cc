// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/base/statistics.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace pliant {
namespace {

const std::vector<double> kValues = {4, 1, 10, 2};

TEST(Statistics, AreThoseOfTheValuesInAnyOrder) {
  EXPECT_EQ(Median(kValues), 3);
  EXPECT_EQ(Median({4, 1, 10}), 4);
  EXPECT_EQ(Mean(kValues), 4.25);
  EXPECT_EQ(MedianDeviation(kValues), 1.5);  // of 1, 2, 7, 1
  EXPECT_DOUBLE_EQ(Rms(kValues), 5.5);
  // The squares of 0.25, 3.25, 5.75 and 2.25 off the mean are 48.75.
  EXPECT_DOUBLE_EQ(StandardError(kValues), std::sqrt(48.75 / 3 / 4));
}

TEST(Statistics, QuantilesLieBetweenTheNearestValues) {
  EXPECT_EQ(Quantile(kValues, 0), 1);
  EXPECT_EQ(Quantile(kValues, 1), 10);
  EXPECT_EQ(Quantile(kValues, 0.5), 3);
  EXPECT_DOUBLE_EQ(Quantile(kValues, 0.9), 8.2);  // 0.7 of the way from 4 to 10
}

TEST(Statistics, RanksAreCorrelatedWhateverTheDistancesOfTheValues) {
  EXPECT_DOUBLE_EQ(RankCorrelation(kValues, {16, 1, 1e6, 4}), 1);
  EXPECT_DOUBLE_EQ(RankCorrelation(kValues, {-4, 0, -9, -3}), -1);
  EXPECT_DOUBLE_EQ(RankCorrelation({1, 2, 3, 4}, {2, 1, 4, 3}), 0.6);
  EXPECT_DOUBLE_EQ(RankCorrelation({1, 2, 2, 3}, {1, 5, 5, 9}), 1) << "equal values have the same rank";
  EXPECT_EQ(RankCorrelation(kValues, {7, 7, 7, 7}), 0);
}

TEST(Statistics, OfNoValuesAre0) {
  EXPECT_EQ(Median({}), 0);
  EXPECT_EQ(Quantile({}, 0.5), 0);
  EXPECT_EQ(Mean({}), 0);
  EXPECT_EQ(MedianDeviation({}), 0);
  EXPECT_EQ(Rms({}), 0);
  EXPECT_EQ(StandardError({}), 0);
  EXPECT_EQ(RankCorrelation({}, {}), 0);
  EXPECT_EQ(StandardError({7}), 0) << "one value does not say how far values differ";
}

}  // namespace
}  // namespace pliant
