// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// ChArUco boards by OpenCV's contributed module aruco, which is not everywhere.
#pragma once

#include <optional>

#include <opencv2/core/mat.hpp>

#include "pliant/base/status.h"
#include "pliant/board/board.h"
#include "pliant/board/find_board.h"

namespace pliant {

// As CheckBoardIsSupported and FindBoard.
Status CheckCharucoIsSupported(const CalibrationBoard& board);
std::optional<BoardView> FindCharuco(const cv::Mat& gray, const CalibrationBoard& board);

// Whether four or more markers of the board's dictionary are seen, of which several are none that a board of this size
// has, or which are not beside each other as it has them.
bool ShowsOtherCharuco(const cv::Mat& gray, const CalibrationBoard& board);

// The ChArUco board that the image shows, by how its markers are beside each other: of whatever numbers of squares, and
// of another dictionary where those of the board's own show none. Its lengths are those of `board`.
std::optional<CalibrationBoard> SeenCharuco(const cv::Mat& gray, const CalibrationBoard& board);

// The squares and markers of a supported board, CV_8UC1, 0 on 255, `px` pixels to a square's side.
cv::Mat DrawCharuco(const CalibrationBoard& board, int px);

}  // namespace pliant
