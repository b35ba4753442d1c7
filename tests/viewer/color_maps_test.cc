// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/color_maps.h"

#include <cmath>

#include <gtest/gtest.h>

namespace pliant {
namespace {

constexpr float kOrder = 40;  // of the 255 levels of a channel

TEST(ColorMaps, ADivergingMapIsGrayInItsMiddleAndHasBlueAndRedEnds) {
  const Rgb middle = ColorAt(ColorMap::kDiverging, 0.5);
  EXPECT_EQ(middle[0], middle[1]);
  EXPECT_EQ(middle[1], middle[2]);
  for (const double share : {0.0, 0.1, 0.2, 0.3}) {
    const Rgb low = ColorAt(ColorMap::kDiverging, share);
    const Rgb high = ColorAt(ColorMap::kDiverging, 1.0 - share);
    EXPECT_GT(low[2], low[0] + kOrder) << share;
    EXPECT_GT(high[0], high[2] + kOrder) << share;
  }
}

TEST(ColorMaps, HaveTheirEndsBeyondTheRangeAndGrayForWhatIsNotKnown) {
  for (const ColorMap map : {ColorMap::kViridis, ColorMap::kDiverging}) {
    EXPECT_EQ(ColorAt(map, -1.0), ColorAt(map, 0.0));
    EXPECT_EQ(ColorAt(map, 2.0), ColorAt(map, 1.0));
    EXPECT_EQ(ColorAt(map, std::nan("")), kUnknownRgb);
  }
  EXPECT_EQ(ColorAt(ColorMap::kViridis, 0.0), (Rgb{68, 1, 84}));
}

}  // namespace
}  // namespace pliant
