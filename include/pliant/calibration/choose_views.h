// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Which views of a board a calibration needs, and which it lacks.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "pliant/board/board.h"
#include "pliant/board/find_board.h"
#include "pliant/calibration/calibrate_camera.h"

namespace pliant {

// At most `max_views` of the views, as different from each other as can be: the view with the largest board, then again
// and again the one whose board's outline is farthest from those of all that are chosen; none whose outline is the same
// as another's to within 1 % of the image's diagonal. Indices, ascending.
std::vector<int> ChooseVariedViews(const CalibrationBoard& board, std::span<const BoardView> views, int width,
                                   int height, int max_views);

// Share of the image's cells, of which there are 12 along its longer side, that hold a point of a view that was used.
double CoveredShare(std::span<const BoardView> views, const CameraCalibration& calibration);

// What would make the calibration better, a sentence each; none where it is good.
std::vector<std::string> CalibrationAdvice(std::span<const BoardView> views, const CameraCalibration& calibration);

}  // namespace pliant
