// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/calibration/choose_views.h"

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

TEST(ChooseViews, HasNoAdviceForGoodViews) {
  const auto poses = VariedBoardPoses(kChessboard9x6, kCamera, 40, 4);
  const std::vector<BoardView> views = ViewsOf(kChessboard9x6, kCamera, poses, 0.05, 1);
  const auto calibration = CalibrateCamera(kChessboard9x6, views, 640, 480, ModelChoice::kSimplePinhole, 2);
  ASSERT_TRUE(calibration.ok());
  EXPECT_THAT(CalibrationAdvice(views, *calibration), testing::IsEmpty());
  EXPECT_GT(CoveredShare(views, *calibration), 0.7);
}

}  // namespace
}  // namespace pliant
