// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A calibration board in an image, by OpenCV: chessboards by Duda and Frese (BMVC 2018), ChArUco boards and circles by
// OpenCV's own detectors.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pliant/board/board.h"

namespace pliant {

// What one image shows of a board. Pixel (0, 0) is the center of the first pixel.
struct BoardView {
  std::vector<int> point_ids;  // numbers of the board's points, ascending; all of them, but for ChArUco boards
  std::vector<Eigen::Vector2d> pixels;
};

// Whether boards of this kind can be found by this build: kInvalidArgument where it was made without OpenCV's module
// aruco, or the dictionary has no such name.
Status CheckBoardIsSupported(const CalibrationBoard& board);

// Nothing where the board is not seen: as a whole, of a ChArUco board at least a third of its corners. A chessboard
// that is larger than `board` may be taken for it, see LargestChessboard. Small images are enlarged, large ones are
// searched at a smaller size and the points found there refined. `gray` is CV_8UC1.
std::optional<BoardView> FindBoard(const cv::Mat& gray, const CalibrationBoard& board);

// The inner corners along the longer and the shorter side of the largest chessboard that is seen; nothing where there
// is none.
struct ChessboardSize {
  int longer = 0;
  int shorter = 0;
  friend bool operator==(const ChessboardSize&, const ChessboardSize&) = default;
};
std::optional<ChessboardSize> LargestChessboard(const cv::Mat& gray);

// A grid of circles that is seen and has more columns or rows than `board`, which is a part of it; nothing where there
// is none.
std::optional<CalibrationBoard> LargerCircles(const cv::Mat& gray, const CalibrationBoard& board);

// A board that is seen where `board` is not: a ChArUco board of other numbers of squares or another dictionary; circles
// of the other kind, with the numbers of columns and rows exchanged, or one or two more or fewer of them. Its lengths
// are those of `board`. Nothing where there is none, and for chessboards: LargestChessboard.
std::optional<CalibrationBoard> SimilarBoard(const cv::Mat& gray, const CalibrationBoard& board);

// Whether markers of a ChArUco board's dictionary are seen, but not those of a board of this size in its order.
bool ShowsOtherMarkers(const cv::Mat& gray, const CalibrationBoard& board);

// An image of which LargestChessboard has the same answer: of a large one a smaller one, in which the search begins.
cv::Mat AsSearched(const cv::Mat& gray);

// Whether a ChArUco board is seen in the mirror image.
bool IsMirrored(const cv::Mat& gray, const CalibrationBoard& board);

}  // namespace pliant
