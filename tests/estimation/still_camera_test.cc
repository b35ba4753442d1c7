// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/window/still_camera.h"

#include <numeric>

#include <gtest/gtest.h>

#include "estimation/deforming_scene.h"

namespace pliant {
namespace {

using deforming_test::DeformingScene;
using deforming_test::kFocalPx;

constexpr double kAlike = 1.1;     // times the errors of the other model: both leave noise
constexpr double kFarWorse = 2.0;  // the same, of a model that cannot be
constexpr double kMuchNoisePx = 1.0;
constexpr double kLittle = 0.05;  // of the scene's camera motion
constexpr int kManyViews = 25;

constexpr double kByChance = 3.0;  // standard errors

// Over all views but the reference.
CameraMotionEvidence EvidenceOf(const DeformingScene& scene) {
  const auto solution = SolveDeformingWindow(scene.Start(0), kFocalPx, {});
  EXPECT_TRUE(solution.ok()) << solution.status().message();
  const auto models = SolveCameraMotionModels(*solution, kFocalPx, {});
  EXPECT_TRUE(models.ok()) << models.status().message();
  if (!models.ok()) return {};
  std::vector<int> views(scene.poses.size() - 1);
  std::iota(views.begin(), views.end(), 1);
  return EvidenceOfCameraMotion(*models, views, 0.0);
}

double RatioOf(const DeformingScene& scene) { return EvidenceOf(scene).error_ratio; }

DeformingScene BeforeAStillCamera() {
  DeformingScene scene;
  for (Rigid3& pose : scene.poses) pose = Rigid3();
  return scene;
}

TEST(StillCamera, ExplainsAWindowInWhichTheSceneAloneMoves) { EXPECT_LT(RatioOf(BeforeAStillCamera()), kAlike); }

TEST(StillCamera, ExplainsAWindowInWhichTheCameraOnlyTurns) {
  DeformingScene scene;
  for (Rigid3& pose : scene.poses) pose.translation.setZero();
  EXPECT_LT(RatioOf(scene), kAlike);
}

TEST(StillCamera, DoesNotExplainAWindowInWhichTheCameraMoves) { EXPECT_GT(RatioOf(DeformingScene()), kFarWorse); }

// Noise is most of both errors here, and the camera moves by a few millimeters: the errors alone are 1.35 times as
// large.
TEST(StillCamera, IsToldFromOneThatMovesALittleInMuchNoise) {
  DeformingScene moving(kManyViews);
  for (Rigid3& pose : moving.poses) pose.translation *= kLittle;
  DeformingScene still(kManyViews);
  for (Rigid3& pose : still.poses) pose = Rigid3();
  moving.noise_px = still.noise_px = kMuchNoisePx;
  const CameraMotionEvidence of_still = EvidenceOf(still);
  const CameraMotionEvidence of_moving = EvidenceOf(moving);
  EXPECT_LT(of_still.error_ratio, kAlike);
  EXPECT_GT(of_moving.error_ratio, kFarWorse);
  EXPECT_GT(of_moving.significance, kByChance);
  EXPECT_TRUE(of_still.moving_leaves_noise && of_moving.moving_leaves_noise);
}

// The camera is shifted against its solution, by which all errors are alike.
TEST(StillCamera, AModelThatLeavesMoreThanNoiseSaysSo) {
  DeformingScene scene(kManyViews);
  const auto solution = SolveDeformingWindow(scene.Start(0), kFocalPx, {});
  ASSERT_TRUE(solution.ok());
  auto models = SolveCameraMotionModels(*solution, kFocalPx, {});
  ASSERT_TRUE(models.ok());
  for (Rigid3& pose : models->moving.cams_from_world) pose.translation.x() += 1.0;
  std::vector<int> views(scene.poses.size() - 1);
  std::iota(views.begin(), views.end(), 1);
  const CameraMotionEvidence evidence = EvidenceOfCameraMotion(*models, views, 0.0);
  EXPECT_FALSE(evidence.moving_leaves_noise);
  EXPECT_LT(evidence.error_ratio, 1.0);
  EXPECT_LT(evidence.significance, -kByChance);
}

TEST(StillCamera, HasNoTranslationInItsModelAndNoHigherRank) {
  const DeformingScene scene = BeforeAStillCamera();
  const auto solution = SolveDeformingWindow(scene.Start(0), kFocalPx, {});
  ASSERT_TRUE(solution.ok());
  const auto models = SolveCameraMotionModels(*solution, kFocalPx, {.sample_points = 60});
  ASSERT_TRUE(models.ok());
  EXPECT_EQ(models->point_idxs.size(), 120U);
  EXPECT_EQ(models->still.points_in_world.size(), 120U);
  EXPECT_EQ(models->still.coefficients.rows(), kModelRank);
  EXPECT_EQ(models->moving.coefficients.rows(), kModelRank);
  double farthest = 0;
  for (const Rigid3& pose : models->still.cams_from_world) EXPECT_EQ(pose.translation, Eigen::Vector3d::Zero());
  for (const Rigid3& pose : models->moving.cams_from_world) farthest = std::max(farthest, pose.translation.norm());
  EXPECT_GT(farthest, 0.0);
}

TEST(StillCamera, IsNotAskedOfARigidWindow) {
  DeformingScene scene;
  scene.amplitude_mm = 0;
  const auto rigid = SolveRigidWindow(scene.Start(0), kFocalPx, {});
  ASSERT_TRUE(rigid.ok());
  EXPECT_EQ(SolveCameraMotionModels(*rigid, kFocalPx, {}).status().code(), ErrorCode::kInvalidArgument);
}

TEST(StillCamera, IsAsGoodWhereNothingIsCompared) {
  const auto solution = SolveDeformingWindow(DeformingScene().Start(0), kFocalPx, {});
  ASSERT_TRUE(solution.ok());
  const auto models = SolveCameraMotionModels(*solution, kFocalPx, {});
  ASSERT_TRUE(models.ok());
  const CameraMotionEvidence evidence = EvidenceOfCameraMotion(*models, {}, 0.0);
  EXPECT_EQ(evidence.error_ratio, 1.0);
  EXPECT_EQ(evidence.significance, 0.0);
}

}  // namespace
}  // namespace pliant
