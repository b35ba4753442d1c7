// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Whether the points of a board that was found are taken for each other.
#pragma once

#include <vector>

#include <opencv2/core/types.hpp>

#include "pliant/board/board.h"

namespace pliant {

// Whether steps from point to point change little along rows and columns: by at most half of the longer step, whatever
// the lens. (Those of a fisheye change by up to 0.3 of it, those to a point that was taken for another by all of it.)
// `points` are all of the board's, by their number.
bool AreInOrder(const CalibrationBoard& board, const std::vector<cv::Point2f>& points);

}  // namespace pliant
