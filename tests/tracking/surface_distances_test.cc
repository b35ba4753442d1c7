// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/submap/surface_distances.h"

#include <cmath>

#include <gtest/gtest.h>

#include "pliant/base/random.h"
#include "pliant/camera/camera.h"

namespace pliant {
namespace {

constexpr int kNeighbors = 8;

Camera WallCamera() { return *Camera::Create("PINHOLE", 640, 480, std::vector<double>{450, 450, 319.5, 239.5}); }

// A wall that is slanted, or folded along x = 0; its distances with noise.
Eigen::Vector3d OnWall(double x, double y, double fold) { return {x, y, 60 + 0.4 * x - 0.2 * y + (x > 0 ? fold : 0)}; }

Map FoldedWall(double noise, double fold = 0) {
  Random random(1);
  Map map;
  for (int y = -5; y <= 5; ++y)
    for (int x = -5; x <= 5; ++x) {
      Landmark landmark{.id = PointId{static_cast<std::int64_t>(map.landmarks.size())}};
      const Eigen::Vector3d on_wall = OnWall(4 * x + 0.5, 4 * y, fold);
      landmark.position = on_wall * (1.0 + random.Normal(noise));
      landmark.pixel = *WallCamera().Project(on_wall);
      map.landmarks.push_back(landmark);
    }
  return map;
}

std::optional<DistancePrior> DistanceAt(const Map& map, const Eigen::Vector3d& point) {
  return SurfaceDistances(map, Rigid3(), kNeighbors).At(*WallCamera().Project(point), point.normalized());
}

TEST(SurfaceDistances, AreThoseOfTheWallAndAsCertainAsItsPoints) {
  constexpr double kNoise = 0.01;
  int within_two_sigmas = 0;
  int count = 0;
  for (int y = -3; y <= 3; ++y)
    for (int x = -3; x <= 3; ++x) {
      const Eigen::Vector3d truth = OnWall(4 * x + 2, 4 * y + 2, 0);
      const auto distance = DistanceAt(FoldedWall(kNoise), truth);
      ASSERT_TRUE(distance);
      EXPECT_GT(distance->sigma, 0.7 * kNoise);
      EXPECT_LT(distance->sigma, 3.0 * kNoise);
      within_two_sigmas += std::abs(distance->log_distance - std::log(truth.norm())) < 2 * distance->sigma ? 1 : 0;
      ++count;
    }
  EXPECT_GT(within_two_sigmas, 0.9 * count);
}

TEST(SurfaceDistances, AreUncertainAtAFoldAndBeyondTheMap) {
  const Map folded = FoldedWall(0.001, 15);
  const auto flat = DistanceAt(folded, OnWall(-14, 2, 15));
  const auto fold = DistanceAt(folded, OnWall(0, 2, 15));
  const auto beyond = DistanceAt(folded, OnWall(-34, 2, 15));
  ASSERT_TRUE(flat && fold && beyond);
  EXPECT_GT(fold->sigma, 5 * flat->sigma);
  EXPECT_GT(beyond->sigma, 2 * flat->sigma);
}

// The points around a hole in a bowl lie on a plane that tells nothing of the hole's depth.
TEST(SurfaceDistances, AreAsUncertainAcrossAGapAsTheMapIsBent) {
  constexpr double kHole_mm = 9;
  const auto on_bowl = [](double x, double y) { return Eigen::Vector3d(x, y, 60 - 0.03 * (x * x + y * y)); };
  Map map;
  for (int y = -7; y <= 7; ++y)
    for (int x = -7; x <= 7; ++x) {
      Landmark landmark{.id = PointId{static_cast<std::int64_t>(map.landmarks.size())}};
      landmark.position = on_bowl(3 * x, 3 * y);
      landmark.pixel = *WallCamera().Project(landmark.position);
      if (landmark.position.head<2>().norm() > kHole_mm) map.landmarks.push_back(landmark);
    }
  const auto hole = DistanceAt(map, on_bowl(0, 0));
  const auto beside = DistanceAt(map, on_bowl(13.5, 1.5));
  ASSERT_TRUE(hole && beside);
  EXPECT_LT(std::abs(hole->log_distance - std::log(60)), 2 * hole->sigma);
  EXPECT_GT(hole->sigma, 3 * beside->sigma);
}

TEST(SurfaceDistances, AreUnknownWhereTheMapHasNoGapAsWide) {
  Map corner = FoldedWall(0.001);
  std::erase_if(corner.landmarks, [](const Landmark& landmark) { return landmark.position.head<2>().maxCoeff() > 0; });
  EXPECT_TRUE(DistanceAt(corner, OnWall(-2, -2, 0)));
  EXPECT_FALSE(DistanceAt(corner, OnWall(60, 60, 0)));
}

TEST(SurfaceDistances, AreNotToldByPointsThatHaveTheirsFromTheSurface) {
  Map map = FoldedWall(0.001);
  for (Landmark& landmark : map.landmarks) landmark.from_surface = true;
  EXPECT_FALSE(DistanceAt(map, OnWall(2, 2, 0)));
  for (int i = 0; i < 5; ++i) map.landmarks[static_cast<std::size_t>(20 * i)].from_surface = false;
  EXPECT_FALSE(DistanceAt(map, OnWall(2, 2, 0))) << "five points hardly bound a plane";
  EXPECT_FALSE(DistanceAt(Map(), OnWall(2, 2, 0)));
}

}  // namespace
}  // namespace pliant
