// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What a person checks of a calibration, in one picture: every point of the board that was used, at its place in the
// image, with its reprojection error enlarged; how the lens bends a straight grid; and the error of every image.
#pragma once

#include <string>

#include "pliant/base/status.h"
#include "pliant/pipeline/calibrate_images.h"

namespace pliant {

// The ending of `output_path` says what is written: .png, .svg or .pdf. Fails with kInvalidArgument for another one,
// and with kUnwritable.
Status WriteCalibrationFigure(const CalibrateSummary& summary, const std::string& output_path);

}  // namespace pliant
