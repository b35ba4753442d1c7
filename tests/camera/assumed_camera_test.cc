// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/camera/assumed_camera.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pliant {
namespace {

TEST(AssumedCamera, SeesAsWideAsItsNameSays) {
  EXPECT_EQ(AssumedCameraName(70), "fov:70");
  const auto camera = MakeAssumedCamera("fov:90", 640, 480);
  ASSERT_TRUE(camera.ok());
  EXPECT_EQ(camera->model_id(), CameraModelId::kSimplePinhole);
  EXPECT_NEAR(camera->MeanFocalLengthPx(), 320, 1e-9);
  const auto center = camera->Project(Eigen::Vector3d(0, 0, 1));
  EXPECT_NEAR(center->x(), 319.5, 1e-12);
  EXPECT_NEAR(center->y(), 239.5, 1e-12);
}

TEST(AssumedCamera, IsToldFromAFileByItsName) {
  EXPECT_TRUE(IsAssumedCamera("fov:70"));
  EXPECT_FALSE(IsAssumedCamera("camera.yaml"));
  EXPECT_FALSE(IsAssumedCamera(""));
}

TEST(AssumedCamera, RefusesWhatIsNoFieldOfView) {
  for (const char* name : {"fov:", "fov:wide", "fov:nan", "fov:5", "fov:180", "camera.yaml"}) {
    const auto camera = MakeAssumedCamera(name, 640, 480);
    ASSERT_FALSE(camera.ok()) << name;
    EXPECT_EQ(camera.status().code(), ErrorCode::kInvalidArgument);
    EXPECT_THAT(camera.status().message(), testing::HasSubstr("fov:70"));
  }
}

}  // namespace
}  // namespace pliant
