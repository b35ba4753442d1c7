// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/board/draw_board.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "board/charuco.h"
#include "pliant/board/find_board.h"

namespace pliant {
namespace {

constexpr int kDark = 25;    // of print, gray levels of 255
constexpr int kWhite = 204;  // of paper
constexpr int kMostPixels = 8192;
constexpr double kCircleRadius = 0.3;  // by the spacing

void DrawSquares(const CalibrationBoard& board, int px, cv::Mat* image) {
  for (int row = 0; row <= board.rows; ++row)
    for (int column = 0; column <= board.columns; ++column)
      if ((row + column) % 2 == 0) (*image)(cv::Rect((column + 1) * px, (row + 1) * px, px, px)) = kDark;
}

// The first circle is one spacing from the picture's edges.
void DrawCircles(const CalibrationBoard& board, int px, cv::Mat* image) {
  constexpr int kShift = 6;  // binary places of positions
  constexpr double kOne = 1 << kShift;
  for (const Eigen::Vector3d& point : board.Points()) {
    const Eigen::Vector2d center = (point.head<2>() / board.spacing_mm).array() * px + px - 0.5;
    cv::circle(*image,
               {static_cast<int>(std::lround(center.x() * kOne)), static_cast<int>(std::lround(center.y() * kOne))},
               static_cast<int>(std::lround(kCircleRadius * px * kOne)), kDark, cv::FILLED, cv::LINE_AA, kShift);
  }
}

}  // namespace

Result<BoardPicture> DrawBoard(const CalibrationBoard& board, int px_per_spacing) {
  if (Status status = CheckBoardIsSupported(board); !status.ok()) return status;
  const bool has_squares = board.kind == BoardKind::kChessboard || board.kind == BoardKind::kCharuco;
  // In spacings, without the rim: squares reach one beyond the inner corners on each side.
  Eigen::Vector2d last = Eigen::Vector2d::Zero();
  for (const Eigen::Vector3d& point : board.Points()) last = last.cwiseMax(point.head<2>() / board.spacing_mm);
  const int across = static_cast<int>(std::lround(last.x())) + (has_squares ? 2 : 0);
  const int down = static_cast<int>(std::lround(last.y())) + (has_squares ? 2 : 0);
  const int px = std::min(px_per_spacing, kMostPixels / (std::max(across, down) + 2));
  BoardPicture picture;
  picture.mm_per_px = board.spacing_mm / px;
  picture.origin_mm.setConstant((has_squares ? -2 : -1) * board.spacing_mm);
  picture.image = cv::Mat((down + 2) * px, (across + 2) * px, CV_8UC1, cv::Scalar(kWhite));
  if (board.kind == BoardKind::kChessboard) {
    DrawSquares(board, px, &picture.image);
  } else if (board.kind == BoardKind::kCharuco) {
    const cv::Mat squares = DrawCharuco(board, px);
    squares.convertTo(picture.image(cv::Rect(px, px, squares.cols, squares.rows)), CV_8U, (kWhite - kDark) / 255.0,
                      kDark);
  } else {
    DrawCircles(board, px, &picture.image);
  }
  return picture;
}

}  // namespace pliant
