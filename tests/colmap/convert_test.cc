// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/colmap/convert.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "colmap/sample_model.h"

namespace pliant::colmap {
namespace {

TEST(ConvertColmap, TheFirstPixelIsHalfAPixelFurther) {
  const auto camera = ToPliant(SampleModel().cameras[0]);
  ASSERT_TRUE(camera.ok());
  EXPECT_EQ(std::vector<double>(camera->params().begin(), camera->params().end()),
            (std::vector<double>{525.5, 525.25, 319.5, 239.5}));
  EXPECT_EQ(ToPliant(Point2D{0.5, 0.5, 3}), Eigen::Vector2d(0, 0));
  EXPECT_EQ(FromPliant(Eigen::Vector2d(-0.5, 2), 3).y, 2.5);
}

TEST(ConvertColmap, EveryCameraThatPliantHasComesBack) {
  for (int model_id = 0; model_id <= 5; ++model_id) {
    Camera camera{7, model_id, 640, 480, {}};
    const bool one_focal = model_id == 0 || model_id == 2 || model_id == 3;
    camera.params.assign(static_cast<std::size_t>(FindCameraModel(model_id)->num_params), 0.001);
    for (std::size_t i = 0; i < (one_focal ? 1U : 2U); ++i) camera.params[i] = 500;
    camera.params[one_focal ? 1 : 2] = 320;
    camera.params[one_focal ? 2 : 3] = 240;
    const auto ours = ToPliant(camera);
    ASSERT_TRUE(ours.ok()) << ours.status().message();
    const Camera back = FromPliant(*ours, 7);
    EXPECT_EQ(back.params, camera.params);
    EXPECT_EQ(back.model_id, model_id);
    EXPECT_EQ(back.width, 640U);
  }
}

TEST(ConvertColmap, SaysWhichModelPliantDoesNotHave) {
  const auto camera = ToPliant(Camera{1, 7, 640, 480, {1, 2, 3, 4, 5}});
  EXPECT_EQ(camera.status().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(camera.status().message(), testing::HasSubstr("FOV"));
}

TEST(ConvertColmap, PosesAreNormalizedOrRefused) {
  const auto pose = ToPliant(Pose{{2, 0, 0, 0}, {1, 2, 3}});
  ASSERT_TRUE(pose.ok());
  EXPECT_EQ(pose->rotation.w(), 1);
  EXPECT_EQ(FromPliant(*pose).tvec, (std::array<double, 3>{1, 2, 3}));
  EXPECT_FALSE(ToPliant(Pose{{0, 0, 0, 0}, {1, 2, 3}}).ok());
  EXPECT_FALSE(ToPliant(Pose{{1, 0, 0, 0}, {std::numeric_limits<double>::quiet_NaN(), 2, 3}}).ok());
}

}  // namespace
}  // namespace pliant::colmap
