// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How two cameras are mounted on each other, from views of a flat board in both at the same time: bundle adjustment
// (Ceres) of both cameras' parameters, the pose of one in the other and a pose of the board for every pair, with a
// robust loss whose scale is the residuals' own. Pairs whose residuals are clearly larger than the others' are left
// out. Standard deviations are those of a grouped jackknife over the pairs, widened for few pairs (Student's t).
#pragma once

#include <span>
#include <vector>

#include "pliant/base/job_progress.h"
#include "pliant/base/status.h"
#include "pliant/board/board.h"
#include "pliant/board/find_board.h"
#include "pliant/camera/camera.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

struct StereoCameras {
  Camera left;
  Camera right;
  Rigid3 right_from_left;  // mm
  double baseline_sigma_mm = 0;
  double rotation_sigma_deg = 0;
  double rms_px = 0;                     // of the residuals' lengths in both images, over the pairs that are used
  std::vector<bool> is_outlier = {};     // a pair each: left out
  std::vector<double> pair_rms_px = {};  // a pair each

  double BaselineMm() const { return right_from_left.OriginInSource().norm(); }
};

inline constexpr int kFewestCalibrationPairs = 3;

// `left` and `right` are perspective cameras that were calibrated with the same board; their views are given in pairs,
// of the same moment. A chessboard or grid of circles that a view has the other way round (its last point first) is
// turned. Fails with kInvalidArgument for a fisheye, and kInsufficient for fewer than kFewestCalibrationPairs pairs,
// for pairs that no rigid mount explains (their error is more than three times that of each camera alone), and where
// the right camera is not to the right of the left one, or at its place. The task of `progress` is "pairs", of three
// steps.
Result<StereoCameras> CalibrateStereo(const CalibrationBoard& board, const Camera& left, const Camera& right,
                                      std::span<const BoardView> left_views, std::span<const BoardView> right_views,
                                      int threads, const JobProgress& progress = {});

}  // namespace pliant
