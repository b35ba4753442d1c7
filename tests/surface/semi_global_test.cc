// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "surface/semi_global.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace pliant {
namespace {

constexpr int kLevels = 9;
constexpr int kSmallStep = 30;
constexpr int kLargeStep = 300;

int BestAt(const CostVolume& volume, int x, int y) {
  const auto* costs = volume.At(x, y);
  return static_cast<int>(std::min_element(costs, costs + volume.levels) - costs);
}

// Level 2 on the left, 6 on the right.
CostVolume TwoSides() {
  CostVolume volume({20, 12}, kLevels);
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 20; ++x)
      for (int k = 0; k < kLevels; ++k)
        volume.At(x, y)[k] = static_cast<std::int16_t>(k == (x < 10 ? 2 : 6) ? 100 : 700);
  return volume;
}

TEST(SemiGlobal, KeepsAStepThatCostsAskFor) {
  const CostVolume smooth = SmoothCosts(TwoSides(), kSmallStep, kLargeStep, 1);
  for (int y = 0; y < 12; ++y) {
    EXPECT_EQ(BestAt(smooth, 9, y), 2);
    EXPECT_EQ(BestAt(smooth, 10, y), 6);
  }
}

TEST(SemiGlobal, FillsInWhatSaysNothingAndMendsWhatIsAlone) {
  CostVolume volume = TwoSides();
  std::fill_n(volume.At(4, 5), kLevels, std::int16_t{500});
  std::swap(volume.At(14, 6)[6], volume.At(14, 6)[0]);
  volume.At(14, 6)[6] = 300;
  const CostVolume smooth = SmoothCosts(volume, kSmallStep, kLargeStep, 1);
  EXPECT_EQ(BestAt(smooth, 4, 5), 2);
  EXPECT_EQ(BestAt(smooth, 14, 6), 6);
}

TEST(SemiGlobal, DoesNotOverflowAtTheLargestCosts) {
  CostVolume volume({16, 16}, kLevels);
  std::ranges::fill(volume.costs, std::int16_t{CostVolume::kLargestCost});
  const CostVolume smooth = SmoothCosts(volume, CostVolume::kLargestCost, CostVolume::kLargestCost, 2);
  for (const std::int16_t cost : smooth.costs) EXPECT_GE(cost, 0);
}

}  // namespace
}  // namespace pliant
