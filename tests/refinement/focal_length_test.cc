// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/refinement/focal_length.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "refinement/recorded_scene.h"

namespace pliant {
namespace {

using refinement_test::RecordedScene;
using refinement_test::RecordingCamera;

// The camera of the recording with a wrong focal length.
Camera Assumed(double factor) { return RecordingCamera().WithFocalLengthTimes(factor).value(); }

TEST(FocalLength, IsFoundFromARigidRecording) {
  const Recording recording = RecordedScene(0).Start();
  for (const double assumed : {0.7, 0.9, 1.0, 1.4}) {
    const auto estimate = EstimateFocalLength(Assumed(assumed), recording, {});
    ASSERT_TRUE(estimate.ok()) << assumed << ": " << estimate.status().message();
    const double log_error = std::log(estimate->factor * assumed);
    EXPECT_LT(std::abs(log_error), 0.03) << assumed;
    EXPECT_LT(std::abs(log_error), 4 * estimate->log_sigma) << assumed;
    EXPECT_GT(estimate->log_sigma, 0) << assumed;
  }
}

TEST(FocalLength, IsNotFoundFromASceneThatDeforms) {
  const auto estimate = EstimateFocalLength(Assumed(0.9), RecordedScene().Start(), {});
  ASSERT_FALSE(estimate.ok());
  EXPECT_THAT(estimate.status().code(), testing::AnyOf(ErrorCode::kDegenerate, ErrorCode::kInsufficient));
}

TEST(FocalLength, IsNotFoundFromAMotionAlongTheOpticalAxis) {
  RecordedScene scene(0);
  for (std::size_t v = 0; v < scene.poses.size(); ++v)
    scene.poses[v] = {Eigen::Quaterniond::Identity(), Eigen::Vector3d(-20, 0, -0.5 * static_cast<double>(v))};
  const auto estimate = EstimateFocalLength(Assumed(0.9), scene.Start(), {});
  ASSERT_FALSE(estimate.ok()) << estimate->factor << " +- " << estimate->log_sigma;
  EXPECT_EQ(estimate.status().code(), ErrorCode::kInsufficient);
  EXPECT_THAT(estimate.status().message(), testing::HasSubstr("focal length"));
}

TEST(FocalLength, RefusesARecordingThatIsNone) {
  EXPECT_EQ(EstimateFocalLength(Assumed(1), {}, {}).status().code(), ErrorCode::kInsufficient);
}

}  // namespace
}  // namespace pliant
