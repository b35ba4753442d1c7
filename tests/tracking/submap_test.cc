// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/submap/submap.h"

#include <vector>

#include <gtest/gtest.h>

namespace pliant {
namespace {

constexpr double kSigma = 0.01;

// A map of two points, one of which has no known sigma.
Submap MapWithSignal(double signal) {
  Submap submap(0, Camera::Create("PINHOLE", 640, 480, std::vector<double>{500, 500, 319.5, 239.5}).value(), {});
  submap.depths = {.sigma = kSigma, .signal = signal};
  submap.map.landmarks.resize(2);
  submap.map.landmarks[0].log_distance_sigma = kSigma;
  return submap;
}

TEST(Submap, ThatBecomesProvisionalHasSigmasOfDepthsThatJustStandOut) {
  Submap submap = MapWithSignal(8);
  submap.BecomeProvisional();
  EXPECT_TRUE(submap.provisional);
  EXPECT_EQ(submap.depths.signal, kMinProvisionalSignal);
  EXPECT_DOUBLE_EQ(submap.map.landmarks[0].log_distance_sigma, 8 / kMinProvisionalSignal * kSigma);
  EXPECT_EQ(submap.map.landmarks[1].log_distance_sigma, 0) << "not known";
}

TEST(Submap, WhoseDepthsDoNotStandOutKeepsItsSigmas) {
  Submap submap = MapWithSignal(1.5);
  submap.BecomeProvisional();
  EXPECT_TRUE(submap.provisional);
  EXPECT_EQ(submap.depths.signal, 1.5);
  EXPECT_EQ(submap.map.landmarks[0].log_distance_sigma, kSigma);
}

}  // namespace
}  // namespace pliant
