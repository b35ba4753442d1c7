// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Several runs in one figure for a paper, frame by frame: surface RMSE with its null, camera error (ATE), points. A
// panel is drawn for each of these that the evaluation of at least one run has, in millimeters, above one another with
// one axis of frames. The figure is one column wide (3.4 inches), and its letters are of 7 to 8 points at this width.
//
// A run is told by a color (of Okabe and Ito's, which the color-blind tell apart) and by the shape of its markers,
// which also remains in gray. Its line ends where a frame has no value: where it was not tracked, or has no truth.
// Every run has its own null, that of its own points; all are dashed and gray. Where it is far above the runs, the
// scale of the surface RMSE is logarithmic; else all begin at 0.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/evaluation/evaluation.h"

namespace pliant {

// The runs in the legend: the names of their folders, with as many folders above as tell them apart, and a number where
// that is not enough.
std::vector<std::string> ComparisonNames(std::span<const Evaluation> evaluations);

// The ending of `output_path` says what is written: .pdf, .svg or .png (with 600 pixels an inch). Fails with
// kInvalidArgument for another one, with kInsufficient where no run has anything to draw, and with kUnwritable.
Status WriteComparisonFigure(std::span<const Evaluation> evaluations, const std::string& output_path);

}  // namespace pliant
