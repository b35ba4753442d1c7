// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/map_upkeep/drifted_points.h"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/base/random.h"

namespace pliant {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kMaxChange = 0.02;
constexpr int kPointsInARow = 12;  // points in a row, of as many rows

// A wall that three maps saw; the last of them bends it, by 6 % from one side to the other, and errs by half a per
// cent.
struct Wall {
  Rigid3 cam_from_world = Rigid3(RotationExp(Eigen::Vector3d(0.1, -0.2, 0.05)), Eigen::Vector3d(3, -2, -10));
  Map map;
  std::vector<InitPosition> reestimated;

  Wall() {
    Random random(3);
    for (int i = 0; i < kPointsInARow * kPointsInARow; ++i) {
      const int row = i / kPointsInARow;
      const Eigen::Vector3d in_cam(4.0 * (i % kPointsInARow) - 22, 4.0 * row - 22, 60);
      Landmark landmark{.id = PointId{i}, .position = cam_from_world.Inverse() * in_cam, .times_reestimated = 2};
      map.landmarks.push_back(landmark);
      Put(i, 1 + 0.06 * (i % kPointsInARow) / kPointsInARow + random.Normal(0.005));
    }
  }
  // Where the last map has a point, by where it was.
  void Put(int i, double ratio) {
    const Eigen::Vector3d in_cam = cam_from_world * map.landmarks[static_cast<std::size_t>(i)].position;
    reestimated.resize(std::max(reestimated.size(), static_cast<std::size_t>(i) + 1));
    reestimated[static_cast<std::size_t>(i)] = {PointId{i}, cam_from_world.Inverse() * Eigen::Vector3d(ratio * in_cam)};
  }
  std::vector<PointId> Drifted() const { return DriftedPoints(reestimated, cam_from_world, map, kMaxChange); }
};

TEST(DriftedPoints, AreThoseThatMoveOtherwiseThanTheirNeighbors) {
  Wall wall;
  EXPECT_THAT(wall.Drifted(), IsEmpty()) << "a wall that bends takes its points along";
  wall.Put(40, 0.95);
  wall.Put(101, 1.12);
  EXPECT_THAT(wall.Drifted(), ElementsAre(PointId{40}, PointId{101}));
}

TEST(DriftedPoints, AreNoneOfThoseThatOneMapAloneHadBefore) {
  Wall wall;
  wall.Put(40, 0.95);
  wall.map.landmarks[40].times_reestimated = 1;
  EXPECT_THAT(wall.Drifted(), IsEmpty());
}

TEST(DriftedPoints, ThatTheMapDoesNotHaveAreNone) {
  Wall wall;
  wall.Put(40, 0.95);
  wall.reestimated.erase(wall.reestimated.begin() + 40);
  wall.reestimated.push_back({PointId{1000}, Eigen::Vector3d(0, 0, 5)});
  EXPECT_THAT(wall.Drifted(), IsEmpty());
  wall.reestimated.clear();
  EXPECT_THAT(wall.Drifted(), IsEmpty());
}

// Where all points err more, more is needed.
TEST(DriftedPoints, ErrByMoreThanThreeStandardDeviations) {
  Wall wall;
  Random random(5);
  for (int i = 0; i < kPointsInARow * kPointsInARow; ++i) wall.Put(i, 1 + random.Normal(0.02));
  wall.Put(40, 0.95);
  EXPECT_THAT(wall.Drifted(), testing::Not(testing::Contains(PointId{40})));
  wall.Put(40, 0.85);
  EXPECT_THAT(wall.Drifted(), testing::Contains(PointId{40}));
}

}  // namespace
}  // namespace pliant
