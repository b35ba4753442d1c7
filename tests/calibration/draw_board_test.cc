// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/board/draw_board.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "pliant/board/find_board.h"

namespace pliant {
namespace {

// Of the points as they are numbered; false where the board is found turned.
bool AreAtTheirPlaces(const BoardPicture& picture, const CalibrationBoard& board, const BoardView& view) {
  constexpr double kNear_px = 0.3;
  const std::vector<Eigen::Vector3d> points = board.Points();
  for (std::size_t i = 0; i < view.pixels.size(); ++i) {
    const Eigen::Vector2d drawn =
        ((points[view.point_ids[i]].head<2>() - picture.origin_mm) / picture.mm_per_px).array() - 0.5;
    if ((view.pixels[i] - drawn).norm() > kNear_px) return false;
  }
  return true;
}

// The same numbers for the board turned by half a turn.
BoardView Turned(BoardView view) {
  std::reverse(view.pixels.begin(), view.pixels.end());
  return view;
}

TEST(DrawBoard, PointsAreFoundWhereTheyAreDrawn) {
  for (const CalibrationBoard& board :
       {CalibrationBoard{BoardKind::kChessboard, 7, 5, 3.0}, CalibrationBoard{BoardKind::kChessboard, 9, 6, 2.0},
        CalibrationBoard{BoardKind::kCircles, 7, 6, 5.0}, CalibrationBoard{BoardKind::kAsymmetricCircles, 4, 9, 2.5}}) {
    const auto picture = DrawBoard(board, 40);
    ASSERT_TRUE(picture.ok()) << picture.status().message();
    EXPECT_DOUBLE_EQ(picture->mm_per_px, board.spacing_mm / 40);
    const auto view = FindBoard(picture->image, board);
    ASSERT_TRUE(view.has_value()) << board.Title();
    EXPECT_TRUE(AreAtTheirPlaces(*picture, board, *view) || AreAtTheirPlaces(*picture, board, Turned(*view)))
        << board.Title();
  }
}

TEST(DrawBoard, MarkersOfACharucoBoardAreFound) {
  const CalibrationBoard board = {BoardKind::kCharuco, 7, 4, 10.0, 7.0, "5X5_100"};
  if (!CheckBoardIsSupported(board).ok()) GTEST_SKIP() << "OpenCV came without its module aruco";
  const auto picture = DrawBoard(board, 60);
  ASSERT_TRUE(picture.ok());
  EXPECT_EQ(picture->image.size(), cv::Size(10 * 60, 7 * 60));
  const auto view = FindBoard(picture->image, board);
  ASSERT_TRUE(view.has_value());
  EXPECT_EQ(view->pixels.size(), 28u);
  EXPECT_TRUE(AreAtTheirPlaces(*picture, board, *view));
}

TEST(DrawBoard, LargeBoardsGetFewerPixels) {
  const auto picture = DrawBoard({BoardKind::kChessboard, 100, 3, 1.0}, 1000);
  ASSERT_TRUE(picture.ok());
  EXPECT_LE(picture->image.cols, 8192);
  EXPECT_DOUBLE_EQ(picture->mm_per_px * picture->image.cols, 103.0);
}

TEST(DrawBoard, SaysThatThereIsNoSuchDictionary) {
  EXPECT_EQ(DrawBoard({BoardKind::kCharuco, 7, 4, 10.0, 7.0, "5X5_101"}, 60).status().code(),
            ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace pliant
