// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/map_upkeep/replace_map.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "support/small_run.h"

namespace pliant {
namespace {

constexpr double kSameRay = 1e-6;          // mm^2, of a cross product of positions some 50 mm away
constexpr double kTriangulated_mm = 1e-3;  // from exact rays
constexpr double kLogRounding = 1e-9;      // of logarithms of distances, through poses and back

// The map made again is right, in a unit of its own; the one there is has wrong depths, and points of its own.
struct TwoMaps {
  Rigid3 before = Rigid3(RotationExp(Eigen::Vector3d(0.1, -0.2, 0.05)), Eigen::Vector3d(3, -2, -10));
  Rigid3 after = Rigid3(RotationExp(Eigen::Vector3d(0.11, -0.2, 0.05)), Eigen::Vector3d(1.4, -1, -5));
  Map map;
  InitOutcome outcome;

  TwoMaps() {
    outcome.frames.push_back({0, Rigid3(), {}});
    outcome.frames.push_back({9, after, {}});
    for (int i = 0; i < 9; ++i) {
      const Eigen::Vector3d in_cam(2.0 * i - 8, 0.5 * i, 40 + i);
      const Eigen::Vector3d position = before.Inverse() * in_cam;
      map.landmarks.push_back({PointId{i}, position - Eigen::Vector3d(0, 0, 1), position, Eigen::Vector3d(1, 1, 1)});
      // Half as large as the other; those to either side of the middle nearer and farther.
      if (i != 3)
        outcome.frames[1].positions.push_back(
            {PointId{i}, after.Inverse() * Eigen::Vector3d((0.5 + 0.01 * (i - 4)) * in_cam)});
    }
    outcome.frames[1].positions.push_back({PointId{20}, Eigen::Vector3d(0, 0, 50)});
  }
};

Submap SubmapOf(const TwoMaps& maps) {
  Submap submap(0, TestCamera(), TrackerOptions());
  submap.map = maps.map;
  submap.last_cam_from_world = maps.before;
  submap.before_last_cam_from_world = maps.before;
  return submap;
}

TEST(ReplaceMap, KeepsTheUnit) {
  const TwoMaps maps;
  Submap submap = SubmapOf(maps);
  std::vector<RefinedPoint> refined;
  ASSERT_TRUE(ReplaceMap(maps.outcome, {maps.map, maps.before}, &submap, &refined));
  // Of the eight in both the median is between the fifth and the sixth: 0.505.
  const double scale = 0.5 * (1 / 0.50 + 1 / 0.51);
  const Rigid3& pose = submap.last_cam_from_world;
  EXPECT_LT((pose.translation - scale * maps.after.translation).norm(), kLogRounding);
  EXPECT_LT(pose.rotation.angularDistance(maps.after.rotation), kLogRounding);
  ASSERT_EQ(submap.map.landmarks.size(), 9U);
  ASSERT_EQ(refined.size(), 9U);
  for (const InitPosition& point : maps.outcome.frames[1].positions) {
    const Landmark* landmark = submap.map.Find(point.id);
    if (landmark == nullptr) {
      EXPECT_EQ(point.id, PointId{20});
      continue;
    }
    EXPECT_LT((landmark->position - scale * point.position).norm(), kLogRounding);
    EXPECT_EQ(landmark->rest_position, landmark->position);
    EXPECT_EQ(FindById(refined, point.id)->position, landmark->rest_position);
    EXPECT_EQ(landmark->last_motion, Eigen::Vector3d::Zero());
  }
}

TEST(ReplaceMap, LeavesThePointsThatItDoesNotHaveWhereTheCameraSeesThem) {
  TwoMaps maps;
  Landmark& before = *maps.map.Find(PointId{3});
  before.log_distance_sigma = 0.02;
  before.determined_at = before.position + Eigen::Vector3d(0, 1, 0);
  Submap submap = SubmapOf(maps);
  Landmark lost = before;
  lost.id = PointId{30};
  submap.lost_points.Add(lost, maps.before);
  std::vector<RefinedPoint> refined;
  ASSERT_TRUE(ReplaceMap(maps.outcome, {maps.map, maps.before}, &submap, &refined));
  const Rigid3& pose = submap.last_cam_from_world;
  const Landmark& left = *submap.map.Find(PointId{3});
  const Eigen::Vector3d in_cam = maps.before * before.position;
  const Eigen::Vector3d rest_in_cam = maps.before * before.rest_position;
  EXPECT_LT((pose * left.position - in_cam).norm(), kLogRounding);
  EXPECT_LT((pose * left.rest_position - rest_in_cam).norm(), kLogRounding);
  EXPECT_NEAR(DistanceSigma(left, pose), DistanceSigma(before, maps.before), kLogRounding);
  const Landmark& still_lost = *submap.lost_points.Find(lost.id);
  EXPECT_LT((pose * still_lost.position - in_cam).norm(), kLogRounding);
  EXPECT_LT((pose * still_lost.rest_position - rest_in_cam).norm(), kLogRounding);
}

// A point that was followed by other cameras before is triangulated from where they are in the new world.
TEST(ReplaceMap, MovesTheViewsOfCandidates) {
  const Camera camera = TestCamera();
  const TwoMaps maps;
  Submap submap = SubmapOf(maps);
  const Rigid3 first = Rigid3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(6, 0, 0)) * maps.before;
  const Eigen::Vector3d position = maps.before.Inverse() * Eigen::Vector3d(1, 2, 45);
  const auto pixel_in = [&](const Rigid3& pose) { return *camera.Project(pose * position); };
  ASSERT_TRUE(submap.candidates.Add({.id = PointId{40}, .pixel = pixel_in(first)}, first, maps.map));
  const int views = GrowthOptions().min_views;
  for (int view = 1; view < views; ++view) {
    const double share = static_cast<double>(view) / (views - 1);
    const Rigid3 pose = Rigid3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(6 * (1 - share), 0, 0)) * maps.before;
    ASSERT_TRUE(submap.candidates.AddView({.id = PointId{40}, .pixel = pixel_in(pose)}, pose, maps.map));
  }
  std::vector<RefinedPoint> refined;
  ASSERT_TRUE(ReplaceMap(maps.outcome, {maps.map, maps.before}, &submap, &refined));
  const auto certain = submap.candidates.Certain(submap.last_cam_from_world, submap.map, 0.0);
  ASSERT_EQ(certain.size(), 1U);
  EXPECT_LT((submap.last_cam_from_world * certain.front().position - maps.before * position).norm(), kTriangulated_mm);
}

TEST(ReplaceMap, OfOtherPointsChangesNothing) {
  TwoMaps maps;
  maps.outcome.frames[1].positions = {{PointId{20}, Eigen::Vector3d(0, 0, 50)}};
  Submap submap = SubmapOf(maps);
  std::vector<RefinedPoint> refined;
  EXPECT_FALSE(ReplaceMap(maps.outcome, {maps.map, maps.before}, &submap, &refined));
  EXPECT_EQ(submap.map.landmarks.front().position, maps.map.landmarks.front().position);
  EXPECT_EQ(submap.last_cam_from_world.translation, maps.before.translation);
  EXPECT_TRUE(refined.empty());
}

// The scene is rigid: what was found of an earlier frame holds in the present one.
TEST(ReplaceMap, OfAnEarlierFramePutsThePointsWhereItFoundThem) {
  const TwoMaps maps;
  const MapInFrame then{maps.map, maps.before};
  Submap at_once = SubmapOf(maps);
  std::vector<RefinedPoint> refined;
  ASSERT_TRUE(ReplaceMap(maps.outcome, then, &at_once, &refined));
  Submap later = SubmapOf(maps);
  std::erase_if(later.map.landmarks, [](const Landmark& landmark) { return landmark.id == PointId{8}; });
  for (Landmark& landmark : later.map.landmarks) landmark.pixel += Eigen::Vector2d(4, 1);
  refined.clear();
  ASSERT_TRUE(ReplaceMap(maps.outcome, then, &later, &refined));
  EXPECT_EQ(refined.size(), 8U);
  // Without the eighth the unit is that of the seven: 1 / 0.50.
  const double unit = (1 / 0.50) / (0.5 * (1 / 0.50 + 1 / 0.51));
  for (const Landmark& landmark : later.map.landmarks) {
    if (landmark.id == PointId{3}) continue;  // which the outcome does not have
    EXPECT_LT((landmark.position - unit * at_once.map.Find(landmark.id)->position).norm(), kLogRounding);
  }
}

// The outcome's own world does not matter, nor its unit: the camera stays where it is.
TEST(ReestimatedPositions, AreInTheMapsWorldAndUnit) {
  const TwoMaps maps;
  const auto positions = ReestimatedPositions(maps.outcome, maps.before, maps.map, 8);
  const double scale = 0.5 * (1 / 0.50 + 1 / 0.51);
  ASSERT_EQ(positions.size(), 9U);
  for (std::size_t k = 0; k < positions.size(); ++k) {
    const InitPosition& point = maps.outcome.frames[1].positions[k];
    EXPECT_EQ(positions[k].id, point.id);
    EXPECT_LT((maps.before * positions[k].position - scale * (maps.after * point.position)).norm(), kLogRounding);
  }
  EXPECT_TRUE(ReestimatedPositions(maps.outcome, maps.before, maps.map, 9).empty()) << "eight are in both";
}

// Re-estimated positions of a frame, and the map some frames later: it was moved and deformed meanwhile.
struct Later : TwoMaps {
  Camera camera = TestCamera();
  MapInFrame then{map, before};
  Rigid3 cam_now = Rigid3(RotationExp(Eigen::Vector3d(0.12, -0.18, 0.05)), Eigen::Vector3d(2, -2, -9));
  std::vector<InitPosition> reestimated = ReestimatedPositions(outcome, before, map, 8);
  Eigen::Vector2d pixel_of_20{300, 200};

  Later() {
    for (Landmark& landmark : map.landmarks) landmark.position += Eigen::Vector3d(1, 0.1 * landmark.id.value, -0.5);
  }
  std::vector<InitPosition> InPresent() const {
    return BringForward(reestimated, then, camera, {map, cam_now},
                        [&](PointId id) { return id == PointId{20} ? &pixel_of_20 : nullptr; });
  }
};

TEST(BringForward, ChangesDistancesAsTheyChangedThen) {
  const Later later;
  const auto positions = later.InPresent();
  ASSERT_EQ(positions.size(), 9U);
  for (const InitPosition& point : positions) {
    const Landmark* landmark = later.map.Find(point.id);
    if (landmark == nullptr) continue;
    const Eigen::Vector3d was = later.before * later.then.map.Find(point.id)->position;
    const Eigen::Vector3d found = later.before * FindById(later.reestimated, point.id)->position;
    const Eigen::Vector3d is = later.cam_now * landmark->position;
    EXPECT_LT((later.cam_now * point.position - found.norm() / was.norm() * is).norm(), kLogRounding);
  }
}

TEST(BringForward, PutsAPointOutsideTheMapWhereItIsSeen) {
  const Later later;
  const auto positions = later.InPresent();
  const InitPosition* point = FindById(positions, PointId{20});
  ASSERT_NE(point, nullptr);
  const Eigen::Vector3d in_cam = later.cam_now * point->position;
  EXPECT_LT((*later.camera.Project(in_cam) - later.pixel_of_20).norm(), 1e-6);
  EXPECT_NEAR(in_cam.norm(), (later.cam_now * FindById(later.reestimated, PointId{20})->position).norm(), kLogRounding);
}

TEST(BringForward, LeavesOutWhatIsNotSeenAnyMoreAndWhatHasBecomeALandmark) {
  Later later;
  std::erase_if(later.map.landmarks, [](const Landmark& landmark) { return landmark.id == PointId{5}; });
  later.map.landmarks.push_back({.id = PointId{20}, .position = Eigen::Vector3d(0, 0, 50)});
  const auto positions = later.InPresent();
  EXPECT_EQ(FindById(positions, PointId{5}), nullptr);
  EXPECT_EQ(FindById(positions, PointId{20}), nullptr);
  EXPECT_EQ(positions.size(), 7U);
}

// A mean over the maps that had a point, in log distance; the newest counts for a fifth at least.
TEST(AverageWithBefore, TheMoreMapsHadAPointTheLessOneMovesIt) {
  TwoMaps maps;
  for (int i = 0; i < 9; ++i) maps.map.landmarks[static_cast<std::size_t>(i)].times_reestimated = i;
  const auto reestimated = ReestimatedPositions(maps.outcome, maps.before, maps.map, 8);
  auto held = reestimated;
  AverageWithBefore(maps.before, maps.map, 0.2, &held);
  ASSERT_EQ(held.size(), reestimated.size());
  for (std::size_t k = 0; k < held.size(); ++k) {
    const Landmark* landmark = maps.map.Find(held[k].id);
    if (landmark == nullptr || landmark->times_reestimated < 2) {
      EXPECT_EQ(held[k].position, reestimated[k].position);
      continue;
    }
    const double was = std::log((maps.before * landmark->position).norm());
    const double found = std::log((maps.before * reestimated[k].position).norm());
    const double weight = landmark->times_reestimated < 5 ? 1.0 / landmark->times_reestimated : 0.2;
    EXPECT_NEAR(std::log((maps.before * held[k].position).norm()), was + weight * (found - was), kLogRounding);
    EXPECT_LT((maps.before * held[k].position).cross(maps.before * reestimated[k].position).norm(), kSameRay);
  }
}

}  // namespace
}  // namespace pliant
