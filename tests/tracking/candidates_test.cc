// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/submap/candidates.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace pliant {
namespace {

constexpr PointId kCandidate{1000};
constexpr double kNextFrame_px = 0.5;         // the camera's step and the deformation in one frame
constexpr double kAfterCorrection_mm = 1e-4;  // filters that turn with the world are the same but for their solver
constexpr double kCertain = 0.01;             // of the distance: below the certainty that is asked for
constexpr double kRounding = 1e-9;            // many operations on lengths of about 100 mm

constexpr double kNoSurface = 0.0;  // no point is as certain as that: its own views alone count

Camera TestCamera() { return *Camera::Create("PINHOLE", 640, 480, std::vector<double>{450, 450, 319.5, 239.5}); }

// A wall that bends to and fro, and a camera that passes by.
struct Scene {
  Camera camera = TestCamera();
  GrowthOptions options;
  double bend = 0.02;    // gradient of the displacement
  double jitter_px = 0;  // of the candidate's pixels, to and fro

  static Rigid3 Pose(int t) { return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(-0.8 * t, 0, 0.1 * t)}; }
  Eigen::Vector3d Displaced(const Eigen::Vector3d& rest, int t) const {
    return rest + std::sin(0.2 * t) * Eigen::Vector3d(0.5, 1.0 + bend * rest.x(), 0.3);
  }
  Map MapAt(int t) const {
    Map map;
    for (int y = -3; y <= 3; ++y)
      for (int x = -3; x <= 3; ++x) {
        Landmark landmark;
        landmark.id = PointId{static_cast<std::int64_t>(map.landmarks.size())};
        landmark.rest_position = Eigen::Vector3d(5 * x, 5 * y, 60);
        landmark.position = Displaced(landmark.rest_position, t);
        landmark.last_motion = landmark.position - Displaced(landmark.rest_position, t - 1);
        landmark.pixel = *camera.Project(Pose(t) * landmark.position);
        map.landmarks.push_back(landmark);
      }
    return map;
  }
  // Follows a point through frames 0 to `last`.
  Candidates Follow(const Eigen::Vector3d& rest, int last) const {
    Candidates candidates(camera, options);
    EXPECT_TRUE(candidates.Add({kCandidate, Pixel(rest, 0)}, Pose(0), MapAt(0)));
    for (int t = 1; t <= last; ++t) {
      PointTrack track;
      track.id = kCandidate;
      track.pixel = Pixel(rest, t);
      track.ssim = 0.9;
      if (!candidates.AddView(track, Pose(t), MapAt(t))) break;
    }
    return candidates;
  }
  std::vector<Candidates::CertainPoint> CertainAfter(const Eigen::Vector3d& rest, int last) const {
    return Follow(rest, last).Certain(Pose(last), MapAt(last), kNoSurface);
  }
  Eigen::Vector2d Pixel(const Eigen::Vector3d& rest, int t) const {
    return *camera.Project(Pose(t) * Displaced(rest, t)) + (t % 2 == 0 ? 1 : -1) * Eigen::Vector2d(0, jitter_px);
  }
};

TEST(Candidates, BecomeCertainAtTheRightPlaceWhereTheSceneDeforms) {
  const Scene scene;
  const Eigen::Vector3d rest(3, -4, 55);
  constexpr int kLast = 20;
  const auto certain = scene.CertainAfter(rest, kLast);
  ASSERT_EQ(certain.size(), 1U);
  EXPECT_EQ(certain[0].id, kCandidate);
  const Eigen::Vector3d truth = scene.Displaced(rest, kLast);
  EXPECT_LT((certain[0].position - truth).norm(), kCertain * truth.norm());
}

TEST(Candidates, AreNotCertainAtOnce) {
  const Scene scene;
  EXPECT_TRUE(scene.CertainAfter(Eigen::Vector3d(3, -4, 55), scene.options.min_views - 2).empty());
  GrowthOptions at_once;
  at_once.min_views = 2;
  Scene hasty;
  hasty.options = at_once;
  EXPECT_TRUE(hasty.CertainAfter(Eigen::Vector3d(3, -4, 55), 1).empty()) << "0.8 mm of parallax";
}

// What its surroundings do is known of a far point only as far as they all do the same.
TEST(Candidates, FarFromTheMapTheyStayUncertainWhereItBends) {
  const Eigen::Vector3d far(3, -4, 200);
  constexpr int kLast = 40;
  Scene stiff;
  stiff.bend = 0;
  stiff.options.noise_px = 0.05;
  EXPECT_EQ(stiff.CertainAfter(far, kLast).size(), 1U);
  Scene soft = stiff;
  soft.bend = 0.05;
  EXPECT_TRUE(soft.CertainAfter(far, kLast).empty());
}

// The parallax of eight frames says little of a point on the wall; the wall says more.
TEST(Candidates, OnTheSurfaceOfTheMapTheyAreAsCertainAsItsPoints) {
  const Eigen::Vector3d on_wall(2, -4, 60);
  constexpr int kLast = 8;
  Scene scene;
  scene.options.scarce_points = 0;
  scene.options.noise_px = 2.0;
  scene.jitter_px = 0.3;
  Candidates candidates = scene.Follow(on_wall, kLast);
  EXPECT_TRUE(candidates.Certain(Scene::Pose(kLast), scene.MapAt(kLast), kNoSurface).empty());
  const auto certain = candidates.Certain(Scene::Pose(kLast), scene.MapAt(kLast), 0.03);
  ASSERT_EQ(certain.size(), 1U);
  EXPECT_TRUE(certain[0].from_surface);
  const Eigen::Vector3d truth = scene.Displaced(on_wall, kLast);
  EXPECT_LT((certain[0].position - truth).norm(), kCertain * truth.norm());
  const auto landmark = candidates.AsLandmark(certain[0], Scene::Pose(kLast), scene.MapAt(kLast));
  ASSERT_TRUE(landmark);
  EXPECT_TRUE(landmark->from_surface);
}

TEST(Candidates, ThatAreCertainByTheirOwnViewsNeedNoSurface) {
  constexpr int kLast = 20;
  const auto certain =
      Scene().Follow(Eigen::Vector3d(3, -4, 55), kLast).Certain(Scene::Pose(kLast), Scene().MapAt(kLast), 0.03);
  ASSERT_EQ(certain.size(), 1U);
  EXPECT_FALSE(certain[0].from_surface);
}

TEST(Candidates, ASurfaceThatTheirViewsContradictDoesNotMoveThem) {
  const Eigen::Vector3d before_wall(3, -4, 40);
  constexpr int kLast = 30;
  Scene scene;
  Candidates candidates = scene.Follow(before_wall, kLast);
  const Eigen::Vector3d truth = scene.Displaced(before_wall, kLast);
  for (const auto& certain : candidates.Certain(Scene::Pose(kLast), scene.MapAt(kLast), 0.03))
    EXPECT_LT((certain.position - truth).norm(), 2 * kCertain * truth.norm());
}

TEST(Candidates, EnterAMapThatRunsShortOfPointsEarlier) {
  const auto first_certain = [](int scarce_points) {
    Scene scene;
    scene.options.scarce_points = scarce_points;
    scene.options.min_views = 3;
    int last = 1;
    while (last < 40 && scene.CertainAfter(Eigen::Vector3d(3, -4, 55), last).empty()) ++last;
    return last;
  };
  const int in_time = first_certain(0);
  EXPECT_EQ(first_certain(49), in_time) << "the map has as many";
  EXPECT_LT(first_certain(147), in_time);
  EXPECT_EQ(first_certain(100000), first_certain(147)) << "no more than three times as uncertain";
}

TEST(Candidates, AreFollowedFromTheirSecondViewOn) {
  const Scene scene;
  const Eigen::Vector3d rest(3, -4, 55);
  EXPECT_TRUE(scene.Follow(rest, 0).FollowedPixels().empty()) << "new in the frame";
  const std::vector<Eigen::Vector2d> pixels = scene.Follow(rest, 1).FollowedPixels();
  ASSERT_EQ(pixels.size(), 1U);
  EXPECT_EQ(pixels[0], scene.Pixel(rest, 1));
}

TEST(Candidates, AreGivenUpWhenTheyAreOld) {
  Scene scene;
  scene.options.max_views = 10;
  EXPECT_EQ(scene.Follow(Eigen::Vector3d(3, -4, 55), 9).size(), 1U);
  EXPECT_EQ(scene.Follow(Eigen::Vector3d(3, -4, 55), 10).size(), 0U);
}

TEST(Candidates, AsALandmarkOneHasTheRestAndTheMotionOfItsSurroundings) {
  Scene scene;
  scene.bend = 0;
  constexpr int kLast = 12;
  const Eigen::Vector3d rest(3, -4, 55);
  Candidates candidates = scene.Follow(rest, kLast);
  const auto landmark =
      candidates.AsLandmark({kCandidate, scene.Displaced(rest, kLast)}, Scene::Pose(kLast), scene.MapAt(kLast));
  ASSERT_TRUE(landmark);
  EXPECT_EQ(landmark->log_distance_sigma, 0) << "the map does not know its own";
  EXPECT_LT((landmark->rest_position - rest).norm(), kRounding);
  EXPECT_LT((landmark->last_motion - (scene.Displaced(rest, kLast) - scene.Displaced(rest, kLast - 1))).norm(),
            kRounding);
  EXPECT_EQ(landmark->pixel, scene.Pixel(rest, kLast));
  EXPECT_FALSE(candidates.AsLandmark({kCandidate, rest}, Scene::Pose(kLast), Map()));
}

TEST(Candidates, AsALandmarkOneIsAsUncertainAsItsSurroundingsAndItsOwnViews) {
  const Scene scene;
  constexpr int kLast = 12;
  const Eigen::Vector3d rest(3, -4, 55);
  Candidates candidates = scene.Follow(rest, kLast);
  Map map = scene.MapAt(kLast);
  for (Landmark& landmark : map.landmarks) {
    landmark.log_distance_sigma = 0.04;
    landmark.determined_at = landmark.position;
  }
  const Candidates::CertainPoint point{kCandidate, scene.Displaced(rest, kLast), 0.03};
  const auto landmark = candidates.AsLandmark(point, Scene::Pose(kLast), map);
  ASSERT_TRUE(landmark);
  EXPECT_NEAR(landmark->log_distance_sigma, 0.05, kRounding);
  EXPECT_EQ(landmark->determined_at, point.position);
}

TEST(Candidates, AreExpectedWhereTheCameraWillSeeThem) {
  const Scene scene;
  const Eigen::Vector3d rest(3, -4, 55);
  Candidates candidates = scene.Follow(rest, 20);
  ASSERT_EQ(candidates.Certain(Scene::Pose(20), scene.MapAt(20), kNoSurface).size(),
            1U);  // its place is now the best guess
  const auto expected = candidates.Predict(Scene::Pose(21));
  ASSERT_EQ(expected.size(), 1U);
  EXPECT_LT((expected[0].pixel - *scene.camera.Project(Scene::Pose(21) * scene.Displaced(rest, 20))).norm(),
            kNextFrame_px);
}

TEST(Candidates, ACorrectionOfTheMapIsNoMotion) {
  const Scene scene;
  const Eigen::Vector3d rest(3, -4, 55);
  constexpr int kLast = 20;
  Candidates candidates = scene.Follow(rest, kLast);
  const Map before = scene.MapAt(kLast);
  Map after = before;
  for (Landmark& landmark : after.landmarks) landmark.position += Eigen::Vector3d(0, 0, 4);
  candidates.TakeCorrection(before, after);
  PointTrack track;
  track.id = kCandidate;
  track.pixel = scene.Pixel(rest, kLast);
  ASSERT_TRUE(candidates.AddView(track, Scene::Pose(kLast), after));
  const auto certain = candidates.Certain(Scene::Pose(kLast), after, kNoSurface);
  ASSERT_EQ(certain.size(), 1U);
  EXPECT_LT((certain[0].position - scene.Displaced(rest, kLast)).norm(), kCertain * rest.norm());
}

// Cameras and points moved alike are the same scene.
TEST(Candidates, MoveWithTheWorld) {
  const Scene scene;
  const Eigen::Vector3d rest(3, -4, 55);
  constexpr int kLast = 20;
  const Rigid3 motion(RotationExp(Eigen::Vector3d(0.3, -0.2, 0.5)), Eigen::Vector3d(20, -5, 7));
  const auto stayed = scene.CertainAfter(rest, kLast);
  Candidates candidates = scene.Follow(rest, kLast / 2);
  candidates.Move(motion);
  for (int t = kLast / 2 + 1; t <= kLast; ++t) {
    Map moved = scene.MapAt(t);
    for (Landmark& landmark : moved.landmarks) landmark.position = motion * landmark.position;
    PointTrack track;
    track.id = kCandidate;
    track.pixel = scene.Pixel(rest, t);
    ASSERT_TRUE(candidates.AddView(track, Scene::Pose(t) * motion.Inverse(), moved));
  }
  Map moved = scene.MapAt(kLast);
  for (Landmark& landmark : moved.landmarks) landmark.position = motion * landmark.position;
  const auto certain = candidates.Certain(Scene::Pose(kLast) * motion.Inverse(), moved, kNoSurface);
  ASSERT_EQ(certain.size(), 1U);
  ASSERT_EQ(stayed.size(), 1U);
  EXPECT_LT((certain[0].position - motion * stayed[0].position).norm(), kAfterCorrection_mm);
}

TEST(Candidates, NeedAMap) {
  Candidates candidates(TestCamera(), GrowthOptions());
  EXPECT_FALSE(candidates.Add({kCandidate, Eigen::Vector2d(100, 100)}, Rigid3(), Map()));
  EXPECT_EQ(candidates.size(), 0U);
}

}  // namespace
}  // namespace pliant
