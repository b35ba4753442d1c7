// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/pose/camera_pose.h"

#include <limits>

#include <gtest/gtest.h>

#include "estimation/frame_scene.h"

namespace pliant {
namespace {

constexpr double kExactRad = 1e-9;        // zero noise: what rounding of pixels (1e-13 of 640) leaves, amplified
constexpr double kExactMm = 1e-7;         // by the weakest direction of the pose
constexpr double kRandomPositions = 1.0;  // of four times the information: the positions differ
constexpr double kNoisyRad = 1e-3;  // 500 points of 0.3 px at f = 500 px: the translation along x and the rotation
constexpr double kNoisyMm = 0.05;   // about y are nearly the same motion; several standard deviations

double RotationDifference(const Rigid3& a, const Rigid3& b) {
  return RotationAngle(a.rotation * b.rotation.conjugate());
}

TEST(PredictCameraPose, RepeatsTheLastMotion) {
  const Rigid3 step(RotationExp({0.01, 0.02, -0.03}), {1, 2, 3});
  const Rigid3 before_last(RotationExp({0.5, 0.1, 0.2}), {-4, 5, 6});
  const Rigid3 last = step * before_last;
  const Rigid3 predicted = PredictCameraPose(before_last, last);
  EXPECT_LT(RotationDifference(predicted, step * last), kExactRad);
  EXPECT_LT((predicted.translation - (step * last).translation).norm(), kExactMm);
}

TEST(CameraPose, IsExactWithoutNoise) {
  const FrameScene scene = MakeFrameScene({.deformation_mm = 0, .pixel_noise_px = 0, .outlier_ratio = 0});
  const auto pose = EstimateCameraPose(scene.camera, scene.positions, scene.pixels, Predicted(scene), {});
  ASSERT_TRUE(pose.ok());
  EXPECT_TRUE(pose->converged);
  EXPECT_LT(RotationDifference(pose->cam_from_world, scene.true_cam_from_world), kExactRad);
  EXPECT_LT((pose->cam_from_world.translation - scene.true_cam_from_world.translation).norm(), kExactMm);
  EXPECT_EQ(pose->num_inliers, 500);
  EXPECT_EQ(pose->num_used, 500);
}

TEST(CameraPose, FindsOutliersAndIsHardlyMovedByThem) {
  const FrameScene scene = MakeFrameScene({.deformation_mm = 0, .outlier_ratio = 0.1});
  const auto pose = EstimateCameraPose(scene.camera, scene.positions, scene.pixels, Predicted(scene), {});
  ASSERT_TRUE(pose.ok());
  EXPECT_LT(RotationDifference(pose->cam_from_world, scene.true_cam_from_world), kNoisyRad);
  EXPECT_LT((pose->cam_from_world.OriginInSource() - scene.true_cam_from_world.OriginInSource()).norm(), kNoisyMm);
  for (std::size_t i = 0; i < scene.positions.size(); ++i)
    EXPECT_EQ(pose->inliers[i] != 0, scene.is_outlier[i] == 0) << i;
}

TEST(CameraPose, CovarianceShrinksWithTheNumberOfPoints) {
  double variances[2];
  for (const int k : {0, 1}) {
    const FrameScene scene =
        MakeFrameScene({.num_points = k == 0 ? 200 : 800, .deformation_mm = 0, .outlier_ratio = 0});
    const auto pose = EstimateCameraPose(scene.camera, scene.positions, scene.pixels, Predicted(scene), {});
    ASSERT_TRUE(pose.ok());
    variances[k] = pose->covariance.trace();
    EXPECT_GT(variances[k], 0);
  }
  EXPECT_NEAR(variances[0] / variances[1], 4.0, kRandomPositions);
}

TEST(CameraPose, LeavesOutPointsBehindTheCamera) {
  FrameScene scene = MakeFrameScene({.deformation_mm = 0, .pixel_noise_px = 0, .outlier_ratio = 0});
  scene.positions[3] = scene.true_cam_from_world.Inverse() * Eigen::Vector3d(1, 2, -30);
  const auto pose = EstimateCameraPose(scene.camera, scene.positions, scene.pixels, Predicted(scene), {});
  ASSERT_TRUE(pose.ok());
  EXPECT_EQ(pose->num_used, 499);
  EXPECT_EQ(pose->inliers[3], 0);
  EXPECT_LT((pose->cam_from_world.translation - scene.true_cam_from_world.translation).norm(), kExactMm);
}

TEST(CameraPose, SaysWhyThereIsNone) {
  FrameScene scene = MakeFrameScene({.num_points = 30, .outlier_ratio = 0});
  const Rigid3 initial = Predicted(scene);
  const auto code = [&](const Rigid3& start, std::size_t num_points, std::size_t num_pixels) {
    return EstimateCameraPose(scene.camera, std::span(scene.positions).first(num_points),
                              std::span(scene.pixels).first(num_pixels), start, {})
        .status()
        .code();
  };
  EXPECT_EQ(code(initial, 30, 29), ErrorCode::kMismatch);
  EXPECT_EQ(code(initial, 3, 3), ErrorCode::kInsufficient);
  EXPECT_EQ(code(initial, 0, 0), ErrorCode::kInsufficient);
  const Rigid3 facing_away = Rigid3(RotationExp({3.14, 0, 0}), {0, 0, 0}) * initial;
  EXPECT_EQ(code(facing_away, 30, 30), ErrorCode::kInsufficient);
  Rigid3 not_a_number = initial;
  not_a_number.translation.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code(not_a_number, 30, 30), ErrorCode::kInvalidArgument);

  scene.pixels[2].x() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(code(initial, 30, 30), ErrorCode::kInvalidArgument);
}

TEST(CameraPose, RefusesPointsOnALine) {
  const FrameScene scene = MakeFrameScene({.num_points = 10});
  const Rigid3 world_from_cam = scene.true_cam_from_world.Inverse();
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector2d> pixels;
  for (int i = 0; i < 10; ++i) {
    const Eigen::Vector3d in_cam(2.0 * i - 9, 0.5 * i, 50 + i);
    points.push_back(world_from_cam * in_cam);
    pixels.push_back(scene.camera.Project(in_cam).value());
  }
  EXPECT_EQ(EstimateCameraPose(scene.camera, points, pixels, scene.true_cam_from_world, {}).status().code(),
            ErrorCode::kDegenerate);
}

}  // namespace
}  // namespace pliant
