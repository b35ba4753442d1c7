// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/base/random.h"

#include <cmath>

#include <gtest/gtest.h>

namespace pliant {
namespace {

constexpr double kStandardErrors = 5;  // a correct generator exceeds them once in two million seeds

TEST(Random, RepeatsAndIsIndependentOfTheMachine) {
  Random random(7);
  EXPECT_EQ(random.Next(), 7191089600892374487ULL);  // an independent splitmix64, seed 7
}

TEST(Random, ChildrenOfDifferentNamesDiffer) {
  const Random parent(1);
  Random noise = parent.Child("noise");
  Random noise_again = parent.Child("noise");
  Random texture = parent.Child("texture");
  const auto first = noise.Next();
  EXPECT_EQ(first, noise_again.Next());
  EXPECT_NE(first, texture.Next());
}

TEST(Random, NormalHasTheRequestedSpread) {
  Random random(3);
  constexpr int kCount = 20000;
  double sum = 0;
  double sum_of_squares = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = random.Normal(2.0);
    sum += x;
    sum_of_squares += x * x;
  }
  EXPECT_NEAR(sum / kCount, 0.0, kStandardErrors * 2.0 / std::sqrt(kCount));
  EXPECT_NEAR(std::sqrt(sum_of_squares / kCount), 2.0, kStandardErrors * 2.0 / std::sqrt(2.0 * kCount));
}

}  // namespace
}  // namespace pliant
