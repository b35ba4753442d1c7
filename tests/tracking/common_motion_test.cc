// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/map_upkeep/common_motion.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "support/tolerances.h"

namespace pliant {
namespace {

constexpr double kOnce = 0.05;           // of the motion: damping leaves a fiftieth of the turn or so
constexpr double kTwice = 0.005;         // and of that again, with what is not linear
constexpr double kDamped_rad = 0.0012;   // of a turn of 0.04
constexpr double kStretched_rad = 1e-3;  // a wall that is not quite symmetric turns a little as it is stretched
constexpr double kAlongTheRow = 1e-4;    // half of the turn about the row itself, which nothing tells
constexpr double kMiddle_mm = 0.02;      // the middle of the row, which was moved by 0.4 mm

// A curved wall, all of it moved from where it rests.
Map WallMovedBy(const Rigid3& motion) {
  Map map;
  for (int i = 0; i < 49; ++i) {
    const int row = i / 7;
    const double x = 4.0 * (i % 7) - 12;
    const double y = 4.0 * row - 12;
    const Eigen::Vector3d rest(x, y, 50 + 0.02 * (x * x + y * y));
    map.landmarks.push_back({.id = PointId{i}, .rest_position = rest, .position = motion * rest});
  }
  return map;
}

void Move(const Rigid3& motion, Map* map) {
  for (Landmark& landmark : map->landmarks) landmark.position = motion * landmark.position;
}

double FarthestFromRest(const Map& map) {
  double farthest = 0;
  for (const Landmark& landmark : map.landmarks)
    farthest = std::max(farthest, (landmark.position - landmark.rest_position).norm());
  return farthest;
}

const Rigid3 kDrift(RotationExp(Eigen::Vector3d(0.02, -0.01, 0.015)), Eigen::Vector3d(1.5, -0.5, 0.3));

TEST(CommonMotion, WhatAllPointsDidTogetherIsTakenBack) {
  Map map = WallMovedBy(kDrift);
  const double before = FarthestFromRest(map);
  Move(CommonMotionToRest(map, 1), &map);
  EXPECT_LT(FarthestFromRest(map), kOnce * before) << "damping leaves a fiftieth of the turn or so";
  Move(CommonMotionToRest(map, 1), &map);
  EXPECT_LT(FarthestFromRest(map), kTwice * before);
}

TEST(CommonMotion, AShareOfItIsTakenBack) {
  const Rigid3 shift(Eigen::Quaterniond::Identity(), Eigen::Vector3d(2, -1, 3));
  const Rigid3 back = CommonMotionToRest(WallMovedBy(shift), 0.05);
  EXPECT_LT((back.translation + 0.05 * shift.translation).norm(), kLengthRoundOff_mm);
  EXPECT_LT(RotationAngle(back.rotation), kLengthRoundOff_mm);
  const Rigid3 turn(RotationExp(Eigen::Vector3d(0, 0, 0.04)), Eigen::Vector3d::Zero());
  EXPECT_NEAR(RotationAngle(CommonMotionToRest(WallMovedBy(turn), 0.05).rotation), 0.05 * 0.04, 0.05 * kDamped_rad);
}

TEST(CommonMotion, PointsAtRestStayThere) {
  const Rigid3 none = CommonMotionToRest(WallMovedBy(Rigid3()), 1);
  EXPECT_LT(none.translation.norm(), kLengthRoundOff_mm);
  EXPECT_LT(RotationAngle(none.rotation), kLengthRoundOff_mm);
}

// Stretching is the scene's own motion.
TEST(CommonMotion, WhatPointsDoApartStays) {
  Map map = WallMovedBy(Rigid3());
  for (Landmark& landmark : map.landmarks) landmark.position.x() *= 1.1;
  const Rigid3 moved = CommonMotionToRest(map, 1);
  EXPECT_LT(moved.translation.norm(), kLengthRoundOff_mm);
  EXPECT_LT(RotationAngle(moved.rotation), kStretched_rad);
}

TEST(CommonMotion, PointsInARowDoNotTurnAboutIt) {
  Map map;
  for (int i = 0; i < 9; ++i) {
    const double side = i % 2 == 0 ? 1e-3 : -1e-3;  // too little to tell a turn by
    const Eigen::Vector3d rest(3.0 * i, side, 50);
    map.landmarks.push_back({.id = PointId{i},
                             .rest_position = rest,
                             .position = rest + Eigen::Vector3d(0.1 * i, 0.01, -0.02 + 10 * side)});
  }
  const Rigid3 moved = CommonMotionToRest(map, 1);
  EXPECT_NEAR(moved.rotation.x(), 0, kAlongTheRow);
  EXPECT_LT((moved * map.landmarks[4].position - map.landmarks[4].rest_position).norm(), kMiddle_mm);
}

TEST(CommonMotion, OfTwoPointsNothingIsSaid) {
  Map map = WallMovedBy(kDrift);
  map.landmarks.resize(2);
  EXPECT_EQ(CommonMotionToRest(map, 1).translation, Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace pliant
