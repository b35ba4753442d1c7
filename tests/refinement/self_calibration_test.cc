// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/refinement/self_calibration.h"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "refinement/recorded_scene.h"

namespace pliant {
namespace {

using refinement_test::RecordedScene;
using refinement_test::RecordingCamera;

// The camera of the recording with a wrong focal length.
Camera Assumed(double factor) { return RecordingCamera().WithFocalLengthTimes(factor).value(); }

double LogErrorOf(const Camera& camera) {
  return std::log(camera.MeanFocalLengthPx() / RecordingCamera().MeanFocalLengthPx());
}

// As where nothing is known: one focal length, no distortion.
Camera AssumedSimple(double focal_px) {
  return Camera::Create("SIMPLE_PINHOLE", 640, 480, std::vector{focal_px, 319.5, 239.5}).value();
}

TEST(SelfCalibration, FindsFocalLengthAndDistortion) {
  for (const double k : {-0.2, -0.08, 0.1}) {
    RecordedScene scene(0);
    scene.camera = Camera::Create("SIMPLE_RADIAL", 640, 480, std::vector{450.0, 319.5, 239.5, k}).value();
    for (const double focal_px : {380.0, 520.0}) {
      const auto estimate = SelfCalibrate(AssumedSimple(focal_px), scene.Start(), {});
      ASSERT_TRUE(estimate.ok()) << k << ": " << estimate.status().message();
      const double log_error = LogErrorOf(estimate->camera);
      EXPECT_LT(std::abs(log_error), 0.03) << k;
      EXPECT_LT(std::abs(log_error), 4 * estimate->log_focal_sigma) << k;
      ASSERT_TRUE(estimate->distortion_sigma) << k;
      const double error = estimate->camera.params().back() - k;
      EXPECT_LT(std::abs(error), 4 * *estimate->distortion_sigma) << k;
      EXPECT_LT(std::abs(error), 0.03) << k;
    }
  }
}

TEST(SelfCalibration, FindsNoDistortionWhereThereIsNone) {
  const auto estimate = SelfCalibrate(AssumedSimple(520), RecordedScene(0).Start(), {});
  ASSERT_TRUE(estimate.ok()) << estimate.status().message();
  EXPECT_EQ(estimate->camera.model_id(), CameraModelId::kSimplePinhole);
  EXPECT_LT(std::abs(LogErrorOf(estimate->camera)), 4 * estimate->log_focal_sigma);
}

TEST(SelfCalibration, IsFoundFromARigidRecording) {
  const Recording recording = RecordedScene(0).Start();
  for (const double assumed : {0.7, 0.9, 1.0, 1.4}) {
    const auto estimate = SelfCalibrate(Assumed(assumed), recording, {});
    ASSERT_TRUE(estimate.ok()) << assumed << ": " << estimate.status().message();
    const double log_error = LogErrorOf(estimate->camera);
    EXPECT_LT(std::abs(log_error), 0.03) << assumed;
    EXPECT_LT(std::abs(log_error), 4 * estimate->log_focal_sigma) << assumed;
    EXPECT_GT(estimate->log_focal_sigma, 0) << assumed;
    EXPECT_FALSE(estimate->distortion_sigma) << assumed;  // PINHOLE: two focal lengths
  }
}

TEST(SelfCalibration, IsNotFoundFromASceneThatDeforms) {
  const auto estimate = SelfCalibrate(Assumed(0.9), RecordedScene().Start(), {});
  ASSERT_FALSE(estimate.ok());
  EXPECT_THAT(estimate.status().code(), testing::AnyOf(ErrorCode::kDegenerate, ErrorCode::kInsufficient));
}

TEST(SelfCalibration, IsNotFoundFromAMotionAlongTheOpticalAxis) {
  RecordedScene scene(0);
  for (std::size_t v = 0; v < scene.poses.size(); ++v)
    scene.poses[v] = {Eigen::Quaterniond::Identity(), Eigen::Vector3d(-20, 0, -0.5 * static_cast<double>(v))};
  const auto estimate = SelfCalibrate(Assumed(0.9), scene.Start(), {});
  ASSERT_FALSE(estimate.ok()) << LogErrorOf(estimate->camera);
  EXPECT_EQ(estimate.status().code(), ErrorCode::kInsufficient);
  EXPECT_THAT(estimate.status().message(), testing::HasSubstr("focal length"));
}

TEST(SelfCalibration, StopsWhenItIsAskedTo) {
  const RecordedScene scene(0);
  int asked = 0;
  const auto stopped = SelfCalibrate(Assumed(0.9), scene.Start(), {}, [&] { return ++asked < 20; });
  EXPECT_EQ(stopped.status().code(), ErrorCode::kInterrupted);
  EXPECT_LT(asked, 60);  // what is asked after it has ended at once
}

TEST(SelfCalibration, RefusesARecordingThatIsNone) {
  EXPECT_EQ(SelfCalibrate(Assumed(1), {}, {}).status().code(), ErrorCode::kInsufficient);
}

}  // namespace
}  // namespace pliant
