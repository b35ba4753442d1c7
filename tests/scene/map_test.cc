// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/scene/map.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

TEST(Map, FindsALandmarkByIdAndSaysWhenThereIsNone) {
  Map map;
  for (const int id : {1, 4, 9}) map.landmarks.push_back({.id = PointId{id}});
  ASSERT_NE(map.Find(PointId{4}), nullptr);
  EXPECT_EQ(map.Find(PointId{4})->id.value, 4);
  EXPECT_EQ(map.Find(PointId{5}), nullptr);
  EXPECT_EQ(map.Find(PointId{10}), nullptr);
}

constexpr double kRounding = 1e-12;

// (E13) 4 % of 50 mm, and 1.5 mm that it has moved by since.
TEST(Landmark, ThatHasMovedIsAsUncertainAsItsMotion) {
  Landmark landmark{
      .id = PointId{1}, .position = {30, 0, 40}, .log_distance_sigma = 0.04, .determined_at = {30, 0, 38.5}};
  EXPECT_NEAR(DistanceSigma(landmark, Rigid3()), 2.5, kRounding);
  landmark.determined_at = landmark.position;
  EXPECT_NEAR(DistanceSigma(landmark, Rigid3()), 2.0, kRounding);
  landmark.determined_at.setZero();
  landmark.log_distance_sigma = 0;
  EXPECT_EQ(DistanceSigma(landmark, Rigid3()), 0) << "not known";
}

TEST(Landmark, InAnotherUnitIsAsCertain) {
  const Landmark landmark{
      .id = PointId{1}, .position = {30, 0, 40}, .log_distance_sigma = 0.04, .determined_at = {30, 0, 38.5}};
  const Sim3 other_from_world{3, RotationExp({0.1, 0.2, 0.3}), {1, 2, 3}};
  const Rigid3 cam_from_world(RotationExp({0, 0.2, 0}), Eigen::Vector3d(1, 1, 1));
  EXPECT_NEAR(DistanceSigma(Moved(other_from_world, landmark), PoseInWorld(other_from_world, cam_from_world)),
              3 * DistanceSigma(landmark, cam_from_world), kRounding);
}

}  // namespace
}  // namespace pliant
