// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/submap/submap.h"

#include <vector>

#include <gtest/gtest.h>

#include "tracking/tracks/patch_tracks.h"

namespace pliant {
namespace {

constexpr double kSigma = 0.01;

// A map of two points, one of which has no known sigma, and of one that is lost.
Submap MapWithSignal(double signal) {
  Submap submap(0, Camera::Create("PINHOLE", 640, 480, std::vector<double>{500, 500, 319.5, 239.5}).value(), {});
  submap.depths = {.sigma = kSigma, .signal = signal};
  submap.map.landmarks.resize(2);
  submap.map.landmarks[0].log_distance_sigma = kSigma;
  submap.lost_points.Add({.id = PointId{7}, .log_distance_sigma = kSigma}, Rigid3());
  return submap;
}

TEST(Submap, ThatBecomesProvisionalHasSigmasOfDepthsThatJustStandOut) {
  Submap submap = MapWithSignal(8);
  submap.BecomeProvisional();
  EXPECT_TRUE(submap.provisional);
  EXPECT_EQ(submap.depths.signal, kMinProvisionalSignal);
  EXPECT_DOUBLE_EQ(submap.map.landmarks[0].log_distance_sigma, 8 / kMinProvisionalSignal * kSigma);
  EXPECT_EQ(submap.map.landmarks[1].log_distance_sigma, 0) << "not known";
  EXPECT_DOUBLE_EQ(submap.lost_points.Find(PointId{7})->log_distance_sigma, 8 / kMinProvisionalSignal * kSigma);
}

TEST(Submap, WhoseDepthsDoNotStandOutKeepsItsSigmas) {
  Submap submap = MapWithSignal(1.5);
  submap.BecomeProvisional();
  EXPECT_TRUE(submap.provisional);
  EXPECT_EQ(submap.depths.signal, 1.5);
  EXPECT_EQ(submap.map.landmarks[0].log_distance_sigma, kSigma);
}

// Its patch is still that of the last sharp image.
TEST(Submap, RemembersWhereTheLastSharpImageShowedAPoint) {
  Submap submap = MapWithSignal(8);
  submap.map.landmarks = {{.id = PointId{1}, .pixel = {10, 10}}};
  PatchTracks tracks(PointTrackerOptions(), 1);
  const auto see = [&](double x, bool in_blur) {
    FollowedPoints followed;
    followed.in_blur = in_blur;
    followed.Add(submap.map.landmarks[0], {.id = PointId{1}, .pixel = {x, 10}});
    followed.solved = {{.position = {0, 0, 50}}};
    submap.Commit(followed, Rigid3(), TrackingState::kTracking, TrackerOptions(), &tracks);
    return submap.map.landmarks[0];
  };
  EXPECT_FALSE(see(11, false).sharp_pixel);
  for (const double x : {12.0, 13.0}) {
    const Landmark blurred = see(x, true);
    EXPECT_EQ(blurred.pixel.x(), x);
    ASSERT_TRUE(blurred.sharp_pixel);
    EXPECT_EQ(blurred.sharp_pixel->x(), 11);
  }
  EXPECT_FALSE(see(14, false).sharp_pixel);
}

}  // namespace
}  // namespace pliant
