// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/submap/lost_points.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace pliant {
namespace {

constexpr double kSamePixel_px = 1e-6;   // and entries of the affine change: round-off, times pixels a mm
constexpr double kPixelRounding = 1e-9;  // px; operations on pixels of some hundreds

Camera LostPointsCamera() { return *Camera::Create("PINHOLE", 640, 480, std::vector<double>{500, 500, 319.5, 239.5}); }

// What the wall has done by time t: it slides and bends, evenly over the few millimeters between points.
Eigen::Vector3d Displaced(const Eigen::Vector3d& rest, double t) {
  return rest + t * Eigen::Vector3d(1 + 0.02 * rest.x(), 0.5, 0.01 * rest.y());
}

std::vector<Landmark> MovingWall(double t) {
  std::vector<Landmark> seen;
  for (int y = -4; y <= 4; ++y)
    for (int x = -4; x <= 4; ++x) {
      const Eigen::Vector3d rest(2 * x, 2 * y, 50);
      seen.push_back({PointId{static_cast<std::int64_t>(seen.size())}, rest, Displaced(rest, t)});
    }
  return seen;
}

Landmark PointAt(const Eigen::Vector3d& rest, const Eigen::Vector3d& own_share, double t) {
  return {PointId{1000}, rest, Displaced(rest, t) + own_share};
}

TEST(LostPoints, MoveWithThePointsAroundThem) {
  constexpr double kBend = 0.05;  // mm: what interpolation over 2 mm misses of the bending, at t = 3
  const Eigen::Vector3d rest(1.2, -0.7, 50);
  const Eigen::Vector3d own_share(0.1, -0.2, 0.3);
  LostPoints lost;
  lost.Add(PointAt(rest, own_share, 1), Rigid3());
  lost.Move(MovingWall(1));
  EXPECT_LT((lost.Find(PointId{1000})->position - PointAt(rest, own_share, 1).position).norm(), kPixelRounding);
  lost.Move(MovingWall(3));
  EXPECT_LT((lost.Find(PointId{1000})->position - PointAt(rest, own_share, 3).position).norm(), kBend);
  lost.Move(MovingWall(1));  // nothing adds up on the way
  EXPECT_LT((lost.Find(PointId{1000})->position - PointAt(rest, own_share, 1).position).norm(), kPixelRounding);
}

TEST(LostPoints, TheOldestIsTheOneLostFirst) {
  LostPoints lost;
  for (const std::int64_t id : {7, 3, 5}) lost.Add({.id = PointId{id}}, Rigid3());
  EXPECT_EQ(lost.Oldest(), PointId{7});
  lost.Remove(PointId{7});
  EXPECT_EQ(lost.Oldest(), PointId{3});
  lost.Remove(PointId{3});  // found
  lost.Add({.id = PointId{3}}, Rigid3());
  EXPECT_EQ(lost.Oldest(), PointId{5});
}

TEST(LostPoints, AreWhereTheyWereAmongNobody) {
  LostPoints lost;
  lost.Add(PointAt({0, 0, 50}, {0, 0, 0}, 2), Rigid3());
  lost.Move({});
  EXPECT_EQ(lost.Find(PointId{1000})->position, Displaced({0, 0, 50}, 2));
}

TEST(LostPoints, AreExpectedWhereTheCameraShouldSeeThem) {
  LostPoints lost;
  const auto add = [&](int id, const Eigen::Vector3d& position) {
    lost.Add({PointId{id}, position, position}, Rigid3());
  };
  add(1, {0, 0, 50});
  add(2, {100, 0, 50});  // outside of the image
  add(3, {0, 0, 10});    // behind the camera, once that has gone 25 mm ahead
  add(4, {5, 0, 50});
  const Rigid3 ahead(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0, 0, -25));
  const auto expected = lost.Expected(LostPointsCamera(), ahead, 10);
  ASSERT_EQ(expected.size(), 2U);
  EXPECT_EQ(expected[0].id, PointId{1});
  EXPECT_LT((expected[0].pixel - Eigen::Vector2d(319.5, 239.5)).norm(), kPixelRounding);
  EXPECT_LT((expected[0].affine_from_latest - 2 * Eigen::Matrix2d::Identity()).norm(), kPixelRounding);  // half as far
  EXPECT_LT((expected[1].pixel - Eigen::Vector2d(419.5, 239.5)).norm(), kPixelRounding);
  // A camera that has turned about its axis by a quarter.
  const Rigid3 turned(RotationExp({0, 0, EIGEN_PI / 2}), Eigen::Vector3d::Zero());
  Eigen::Matrix2d quarter;
  quarter << 0, -1, 1, 0;
  EXPECT_LT((lost.Expected(LostPointsCamera(), turned, 10)[0].affine_from_latest - quarter).norm(), kPixelRounding);
}

// 100 degrees from the axis of a lens that sees there, and from half as far.
TEST(LostPoints, AreExpectedBesideTheCameraWhereTheLensSeesThem) {
  const Camera fisheye =
      *Camera::Create("OPENCV_FISHEYE", 640, 480, std::vector<double>{130, 130, 319.5, 239.5, 0, 0, 0, 0});
  const double angle = 100 * EIGEN_PI / 180;
  const Eigen::Vector3d position = 50 * Eigen::Vector3d(std::sin(angle), 0, std::cos(angle));
  LostPoints lost;
  lost.Add({PointId{1}, position, position}, Rigid3());
  const auto expected = lost.Expected(fisheye, Rigid3(Eigen::Quaterniond::Identity(), -0.5 * position), 10);
  ASSERT_EQ(expected.size(), 1U);
  EXPECT_LT((expected[0].pixel - Eigen::Vector2d(319.5 + 130 * angle, 239.5)).norm(), kSamePixel_px);
  EXPECT_LT((expected[0].affine_from_latest - 2 * Eigen::Matrix2d::Identity()).norm(), kSamePixel_px);
}

// A plane across the ray to a point at the edge of the view, before a camera that turns: its homography, near the
// point.
TEST(LostPoints, ChangeAsAPlaneThatFacesTheCamera) {
  constexpr double kStep_px = 0.01;
  constexpr double kCurved = 1e-3;  // what the homography bends over that step, by the step
  const Camera camera = LostPointsCamera();
  const Eigen::Vector2d pixel(600, 440);
  const Eigen::Vector3d ray = *camera.Unproject(pixel);
  const Eigen::Vector3d position = 50 * ray;
  const Rigid3 turned(RotationExp({0.1, -0.2, 0.3}), Eigen::Vector3d::Zero());
  const auto seen_through = [&](const Eigen::Vector2d& at) -> Eigen::Vector2d {
    const Eigen::Vector3d other = *camera.Unproject(at);
    return *camera.Project(turned * Eigen::Vector3d(50 / ray.dot(other) * other));
  };
  Eigen::Matrix2d change;
  for (int k = 0; k < 2; ++k)
    change.col(k) = (seen_through(pixel + kStep_px * Eigen::Vector2d::Unit(k)) - seen_through(pixel)) / kStep_px;
  LostPoints lost;
  lost.Add({PointId{1}, position, position}, Rigid3());
  const auto expected = lost.Expected(camera, turned, 10);
  ASSERT_EQ(expected.size(), 1U);
  EXPECT_LT((expected[0].affine_from_latest - change).norm(), kCurved);
}

TEST(LostPoints, AreLookedForInTurn) {
  LostPoints lost;
  for (int id = 0; id < 5; ++id) lost.Add({PointId{id}, {0, 0, 50}, {0, 0, 50}}, Rigid3());
  std::vector<std::int64_t> asked;
  for (int frame = 0; frame < 5; ++frame)
    for (const PointPrediction& prediction : lost.Expected(LostPointsCamera(), Rigid3(), 2)) {
      asked.push_back(prediction.id.value);
      lost.CountSearches({prediction.id, PointId{77}});
    }
  EXPECT_EQ(asked, (std::vector<std::int64_t>{0, 1, 2, 3, 4, 0, 1, 2, 3, 4}));
  lost.Remove(PointId{1});
  EXPECT_EQ(lost.size(), 4U);
  EXPECT_EQ(lost.Find(PointId{1}), nullptr);
}

TEST(LostPoints, GiveTheirPlaceUpWhereTheyAreSearchedInVain) {
  LostPoints lost;
  lost.Add({PointId{0}, {0, 0, 50}, {0, 0, 50}}, Rigid3());
  for (int frame = 0; frame < 20; ++frame) lost.Expected(LostPointsCamera(), Rigid3(), 1);  // where the camera was not
  for (int frame = 0; frame < 9; ++frame) lost.CountSearches({PointId{0}});
  EXPECT_EQ(lost.Pixels(LostPointsCamera(), Rigid3()).size(), 1U);
  lost.CountSearches({PointId{0}});
  EXPECT_TRUE(lost.Pixels(LostPointsCamera(), Rigid3()).empty());
  EXPECT_EQ(lost.Expected(LostPointsCamera(), Rigid3(), 1).size(), 1U) << "it is searched on";
}

// Cameras and points moved alike; where they rest stays.
TEST(LostPoints, AreExpectedAtTheSamePixelsWhenAllButRestIsMoved) {
  const Rigid3 motion(RotationExp({0.02, -0.03, 0.01}), Eigen::Vector3d(1, 2, -3));
  const Rigid3 ahead(RotationExp({0, 0.1, 0}), Eigen::Vector3d(0, 0, -25));
  LostPoints lost;
  lost.Add(PointAt({1.2, -0.7, 50}, {0.1, -0.2, 0.3}, 1), Rigid3());
  lost.Move(MovingWall(1));
  LostPoints moved = lost;
  moved.MoveAllButRest(motion);
  const auto here = lost.Expected(LostPointsCamera(), ahead, 1);
  const auto there = moved.Expected(LostPointsCamera(), ahead * motion.Inverse(), 1);
  ASSERT_EQ(here.size(), 1U);
  ASSERT_EQ(there.size(), 1U);
  EXPECT_LT((there[0].pixel - here[0].pixel).norm(), kSamePixel_px);
  EXPECT_LT((there[0].affine_from_latest - here[0].affine_from_latest).norm(), kSamePixel_px);
  EXPECT_EQ(moved.landmarks()[0].rest_position, lost.landmarks()[0].rest_position);
}

TEST(LostPoints, AreExpectedAtTheSamePixelsInAnotherWorld) {
  const Sim3 other_from_world{2.5, RotationExp({0.3, -0.2, 0.9}), {1, 2, 3}};
  const Rigid3 ahead(RotationExp({0, 0.1, 0}), Eigen::Vector3d(0, 0, -25));
  const auto in_other = [&](std::vector<Landmark> seen) {
    for (Landmark& landmark : seen) landmark = Moved(other_from_world, landmark);
    return seen;
  };
  LostPoints lost;
  lost.Add(PointAt({1.2, -0.7, 50}, {0.1, -0.2, 0.3}, 1), Rigid3());
  lost.Move(MovingWall(1));
  LostPoints moved = lost;
  moved.MoveInto(other_from_world);
  const auto expect_same = [&] {
    const auto here = lost.Expected(LostPointsCamera(), ahead, 1);
    const auto there = moved.Expected(LostPointsCamera(), PoseInWorld(other_from_world, ahead), 1);
    ASSERT_EQ(there.size(), here.size());
    EXPECT_LT((there[0].pixel - here[0].pixel).norm(), kSamePixel_px);
    EXPECT_LT((there[0].affine_from_latest - here[0].affine_from_latest).norm(), kSamePixel_px);
  };
  expect_same();
  lost.Move(MovingWall(3));
  moved.Move(in_other(MovingWall(3)));
  expect_same();
}

// Their map was made at time 1, and these points' at 0.
TEST(LostPoints, OfAnotherMapGetTheRestThatTheyWouldHaveHadInThisOne) {
  constexpr double kBend = 0.05;  // mm
  const Eigen::Vector3d rest(1.2, -0.7, 50);
  LostPoints other;
  other.Add({PointId{1000}, Displaced(rest, 1), Displaced(rest, 2)}, Rigid3());
  other.Move(MovingWall(1));
  LostPoints lost;
  lost.TakeOver(std::move(other), MovingWall(2));
  EXPECT_LT((lost.Find(PointId{1000})->rest_position - rest).norm(), kBend);
  for (const double t : {2.0, 3.0}) {
    lost.Move(MovingWall(t));
    EXPECT_LT((lost.Find(PointId{1000})->position - Displaced(rest, t)).norm(), kBend) << t;
  }
}

TEST(LostPoints, OfAnotherMapAreLostFirst) {
  LostPoints lost;
  for (const std::int64_t id : {7, 3}) lost.Add({.id = PointId{id}}, Rigid3());
  LostPoints other;
  for (const std::int64_t id : {6, 2}) other.Add({.id = PointId{id}}, Rigid3());
  lost.TakeOver(std::move(other), {});
  lost.Add({.id = PointId{1}}, Rigid3());
  for (const std::int64_t id : {6, 2, 7, 3, 1}) {
    EXPECT_EQ(lost.Oldest(), PointId{id});
    lost.Remove(PointId{id});
  }
}

}  // namespace
}  // namespace pliant
