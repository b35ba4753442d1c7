// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/calibration/choose_views.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/board_views.h"

namespace pliant {
namespace {

const Camera kCamera = Camera::Create("PINHOLE", 640, 480, std::vector<double>{500, 500, 319.5, 239.5}).value();

TEST(ChooseViews, TakesOneOfViewsThatAreAlike) {
  std::vector<Rigid3> poses(20, BoardPoseAt(kChessboard9x6, {0, 0, 30}, 0.3, 0));
  poses.push_back(BoardPoseAt(kChessboard9x6, {4, 0, 30}, 0.3, 1));
  const std::vector<BoardView> views = ViewsOf(kChessboard9x6, kCamera, poses, 0.2, 1);
  const std::vector<int> chosen = ChooseVariedViews(kChessboard9x6, views, 640, 480, 10);
  EXPECT_EQ(chosen.size(), 2u);
  EXPECT_THAT(chosen, testing::Contains(20));
}

TEST(ChooseViews, TakesTheMostDifferentOnesInOrder) {
  const auto poses = VariedBoardPoses(kChessboard9x6, kCamera, 30, 4);
  const std::vector<int> chosen =
      ChooseVariedViews(kChessboard9x6, ViewsOf(kChessboard9x6, kCamera, poses, 0, 1), 640, 480, 10);
  EXPECT_EQ(chosen.size(), 10u);
  EXPECT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
  EXPECT_TRUE(ChooseVariedViews(kChessboard9x6, {}, 640, 480, 10).empty());
}

TEST(ChooseViews, SaysWhatIsMissing) {
  // All in the upper left.
  std::vector<Rigid3> poses;
  for (int i = 0; i < 6; ++i) poses.push_back(BoardPoseAt(kChessboard9x6, {-12.0 + 0.5 * i, -9, 45}, 0.3, 1.1 * i));
  const std::vector<BoardView> views = ViewsOf(kChessboard9x6, kCamera, poses, 0.02, 1);
  const auto calibration = CalibrateCamera(kChessboard9x6, views, 640, 480, ModelChoice::kSimplePinhole, 1);
  ASSERT_TRUE(calibration.ok()) << calibration.status().message();
  const auto advice = CalibrationAdvice(views, *calibration);
  EXPECT_THAT(advice, testing::Contains(testing::HasSubstr("only 6 images")));
  EXPECT_THAT(advice, testing::Contains(testing::HasSubstr("the lower right")));
  EXPECT_LT(CoveredShare(views, *calibration), 0.35);
}

TEST(ChooseViews, AsksForMoreTilt) {
  std::vector<Rigid3> poses;
  for (int i = 0; i < 16; ++i) {
    const int row = i / 4;
    poses.push_back(BoardPoseAt(kChessboard9x6, {1.0 * (i % 4) - 1.5, row - 1.5, 20.0 + i % 3}, 0.3, 0.9 * i));
  }
  const std::vector<BoardView> views = ViewsOf(kChessboard9x6, kCamera, poses, 0.02, 1);
  const auto calibration = CalibrateCamera(kChessboard9x6, views, 640, 480, ModelChoice::kSimplePinhole, 1);
  ASSERT_TRUE(calibration.ok()) << calibration.status().message();
  EXPECT_THAT(CalibrationAdvice(views, *calibration), testing::Contains(testing::HasSubstr("tilted by")));
}

// Poses in which all points are at least `border_px` from the image's border.
std::vector<Rigid3> CentralPoses(const Camera& camera, double border_px, int count) {
  Random random(5);
  std::vector<Rigid3> poses;
  while (static_cast<int>(poses.size()) < count) {
    const auto ray =
        camera.Unproject({random.Uniform(0.35, 0.65) * camera.width(), random.Uniform(0.35, 0.65) * camera.height()});
    const double distance_mm = random.Uniform(1.8, 2.4) * 18 * camera.MeanFocalLengthPx() / camera.width();
    const Rigid3 pose =
        BoardPoseAt(kChessboard9x6, distance_mm * *ray, random.Uniform(0.3, 0.7), random.Uniform(0.0, 6.28));
    const auto points = kChessboard9x6.Points();
    if (std::ranges::all_of(points, [&](const Eigen::Vector3d& point) {
          const auto pixel = camera.Project(pose * point);
          return pixel && camera.Contains(*pixel, border_px);
        }))
      poses.push_back(pose);
  }
  return poses;
}

const Camera kWideCamera = Camera::Create("RADIAL", 480, 360, std::vector<double>{330, 243, 176, -0.2, 0.03}).value();

TEST(ChooseViews, AsksForPointsInTheCorners) {
  const auto views = ViewsOf(kChessboard9x6, kWideCamera, CentralPoses(kWideCamera, 80, 14), 0.04, 1);
  const auto calibration = CalibrateCamera(kChessboard9x6, views, 480, 360, ModelChoice::kSimpleRadial, 2);
  ASSERT_TRUE(calibration.ok()) << calibration.status().message();
  EXPECT_THAT(CalibrationAdvice(views, *calibration),
              testing::Contains(testing::HasSubstr("the distortion is extrapolated")));
}

// The advice of a calibration whose border is as it is said.
TEST(ChooseViews, SaysWhereTheBorderIsNotKnown) {
  const auto poses = VariedBoardPoses(kChessboard9x6, kCamera, 40, 4);
  const std::vector<BoardView> views = ViewsOf(kChessboard9x6, kCamera, poses, 0.05, 1);
  auto calibration = CalibrateCamera(kChessboard9x6, views, 640, 480, ModelChoice::kSimplePinhole, 2);
  ASSERT_TRUE(calibration.ok());
  ASSERT_EQ(calibration->border.size(), 8u);
  calibration->border[4].sigma_px = 2.34;
  calibration->border[1].model_gap_px = 3.21;
  calibration->border[1].gap_model = CameraModelId::kRadial;
  EXPECT_THAT(
      CalibrationAdvice(views, *calibration),
      testing::ElementsAre(testing::HasSubstr("at the lower right of the image the camera is known to 2.3 px"),
                           testing::HasSubstr("RADIAL explains the images as well, and differs by 3.2 px at the top")));
}

TEST(ChooseViews, NoticesAZoomThatChangedHalfway) {
  const Camera zoomed = kWideCamera.WithFocalLengthTimes(1.045).value();
  const auto poses = VariedBoardPoses(kChessboard9x6, zoomed, 16, 4);
  auto views = ViewsOf(kChessboard9x6, kWideCamera, {poses.begin(), poses.begin() + 8}, 0.05, 1);
  const auto others = ViewsOf(kChessboard9x6, zoomed, {poses.begin() + 8, poses.end()}, 0.05, 2);
  views.insert(views.end(), others.begin(), others.end());
  const auto calibration = CalibrateCamera(kChessboard9x6, views, 480, 360, ModelChoice::kRadial, 2);
  ASSERT_TRUE(calibration.ok()) << calibration.status().message();
  EXPECT_THAT(CalibrationAdvice(views, *calibration),
              testing::Contains(testing::HasSubstr("px in the first half of the images and")));
}

TEST(ChooseViews, HasNoAdviceForGoodViews) {
  const auto poses = VariedBoardPoses(kChessboard9x6, kCamera, 40, 4);
  const std::vector<BoardView> views = ViewsOf(kChessboard9x6, kCamera, poses, 0.05, 1);
  const auto calibration = CalibrateCamera(kChessboard9x6, views, 640, 480, ModelChoice::kSimplePinhole, 2);
  ASSERT_TRUE(calibration.ok());
  EXPECT_THAT(CalibrationAdvice(views, *calibration), testing::IsEmpty());
  EXPECT_GT(CoveredShare(views, *calibration), 0.7);
  // An ordinary number of images, with what a detector is off in ordinary ones.
  const auto fewer = ViewsOf(kChessboard9x6, kCamera, VariedBoardPoses(kChessboard9x6, kCamera, 16, 7), 0.1, 1);
  const auto chosen = CalibrateCamera(kChessboard9x6, fewer, 640, 480, ModelChoice::kAuto, 2);
  ASSERT_TRUE(chosen.ok());
  EXPECT_THAT(CalibrationAdvice(fewer, *chosen), testing::Not(testing::Contains(testing::HasSubstr(" of the image "))));
}

}  // namespace
}  // namespace pliant
