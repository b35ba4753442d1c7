// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/frame_checks.h"

#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pliant {
namespace {

using testing::HasSubstr;

std::vector<double> Every(double step) { return {5 * step, 6 * step, 7 * step, 9 * step}; }

TEST(FrameTimes, AreSecondsThatGrow) {
  EXPECT_TRUE(CheckFrameTimes({}, "times are").ok());
  EXPECT_TRUE(CheckFrameTimes(Every(1 / 30.0), "times are").ok());
  EXPECT_TRUE(CheckFrameTimes(Every(600), "times are").ok()) << "one image in ten minutes";
  EXPECT_TRUE(CheckFrameTimes(std::vector{0.0, 0.1, 0.2, 86400.0}, "times are").ok()) << "a pause of a day";
  for (const double last : {2.0, 1.5, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THAT(CheckFrameTimes(std::vector{1.0, 2.0, last}, "times are").message(),
                HasSubstr("not growing, at frame 2"));
}

TEST(FrameTimes, DifferInWhatARunWritesOfThem) {
  EXPECT_TRUE(CheckFrameTimes(Every(1e-6), "times are").ok());
  EXPECT_TRUE(CheckFrameTimes(std::vector{1.7e9, 1.7e9 + 1e-5}, "times are").ok()) << "of a clock";
  EXPECT_THAT(CheckFrameTimes(Every(1e-7), "times are").message(),
              HasSubstr("times are the same to a microsecond at the frames"));
  EXPECT_FALSE(CheckFrameTimes(std::vector{0.0, 0.1, 0.1 + 4e-7}, "times are").ok());
}

TEST(FrameTimes, OfAnotherUnitAreNamed) {
  EXPECT_THAT(CheckFrameTimes(Every(33333), "times are").message(),
              HasSubstr("times are 33333 apart, as microseconds"));
  EXPECT_THAT(CheckFrameTimes(Every(33333333), "times are").message(),
              HasSubstr("as nanoseconds would be; give seconds"));
}

TEST(DepthPriorSize, HasTheSidesOfTheImages) {
  EXPECT_TRUE(CheckDepthPriorSize({640, 480}, {640, 480}, "it").ok());
  EXPECT_TRUE(CheckDepthPriorSize({518, 392}, {640, 480}, "it").ok());  // multiples of 14
  EXPECT_THAT(CheckDepthPriorSize({480, 640}, {640, 480}, "it").message(),
              HasSubstr("it is 480x640, but the images are"));
}

}  // namespace
}  // namespace pliant
