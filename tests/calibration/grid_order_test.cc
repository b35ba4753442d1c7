// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "board/grid_order.h"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/board_views.h"

namespace pliant {
namespace {

// A board close to a fisheye that sees 180 degrees, from which it is bent as much as boards are.
std::vector<cv::Point2f> BentPoints(const CalibrationBoard& board) {
  const Camera camera =
      Camera::Create("OPENCV_FISHEYE", 640, 640, std::vector<double>{204, 204, 320, 320, 0, 0, 0, 0}).value();
  const std::vector<Eigen::Vector3d> on_board = board.Points();
  const double width_mm = (on_board.back() - on_board.front()).norm();
  std::vector<cv::Point2f> points;
  for (const Eigen::Vector3d& point : on_board) {
    const Eigen::Vector2d pixel =
        *camera.Project(BoardPoseAt(board, {0.3 * width_mm, 0, 0.6 * width_mm}, 0.5, 0.7) * point);
    points.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
  }
  return points;
}

TEST(GridOrder, KnowsPointsThatWereTakenForEachOther) {
  for (const CalibrationBoard& board : {CalibrationBoard{BoardKind::kCircles, 7, 6, 5.0},
                                        CalibrationBoard{BoardKind::kAsymmetricCircles, 4, 11, 2.5}}) {
    std::vector<cv::Point2f> points = BentPoints(board);
    EXPECT_TRUE(AreInOrder(board, points)) << board.Title();
    std::swap(points[8], points[9]);
    EXPECT_FALSE(AreInOrder(board, points)) << board.Title();
  }
}

TEST(GridOrder, KnowsABoardOfOtherColumns) {
  const CalibrationBoard board = {BoardKind::kCircles, 7, 6, 5.0};
  EXPECT_FALSE(AreInOrder({BoardKind::kCircles, 6, 7, 5.0}, BentPoints(board)));
}

}  // namespace
}  // namespace pliant
