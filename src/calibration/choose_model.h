// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Which of several models of one camera is taken, and how well it is known at the image's border.
#pragma once

#include <cstddef>
#include <vector>

#include "calibration/board_problem.h"
#include "calibration/pixel_accuracy.h"
#include "pliant/calibration/calibrate_camera.h"
#include "pliant/camera/camera.h"

namespace pliant {

// A model with all that is known of it.
struct ModelCandidate {
  BoardFit fit;
  Camera camera;
  ParamsCovariance covariance;
  std::vector<double> prediction_errors_px;  // of the views in which it was held out, the same ones for every candidate
};

struct ModelChosen {
  std::size_t chosen = 0;
  std::vector<HeldOutError> errors = {};  // a candidate each
  std::vector<bool> is_as_good = {};      // a candidate each: predicts as well as the best one
};

// Of the candidates that predict as well as the best one that with the fewest parameters; then a larger one that
// contains it and differs from it clearly at the image's border. There is at least one.
ModelChosen ChooseModel(const std::vector<ModelCandidate>& candidates);

// Of the candidate that was chosen.
std::vector<PixelAccuracy> BorderAccuracy(const std::vector<ModelCandidate>& candidates, const ModelChosen& choice);

}  // namespace pliant
