// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The picture of a board, as it is printed.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pliant/base/status.h"
#include "pliant/board/board.h"

namespace pliant {

struct BoardPicture {
  cv::Mat image;              // CV_8UC1, dark on white, with a white rim of one spacing around squares or circles
  Eigen::Vector2d origin_mm;  // the upper left corner of its upper left pixel, in the board's frame
  double mm_per_px = 0;
};

// `px_per_spacing`: pixels to a square's side or the distance of two circles, 8 to 1000; fewer where the picture would
// have more than 8192 pixels along a side. Fails as CheckBoardIsSupported does.
Result<BoardPicture> DrawBoard(const CalibrationBoard& board, int px_per_spacing);

}  // namespace pliant
