// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// OpenCV's calibrations: names, coefficients and the models that they become.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/io/camera_file.h"

namespace pliant {

// A calibration file's entries by name, whatever its syntax: the numbers of a matrix, list or single value (empty:
// there is no such entry), or the text of one (empty likewise).
struct CalibrationEntries {
  std::function<std::vector<double>(std::string_view)> numbers;
  std::function<std::string(std::string_view)> text;
};

// Whether there is a camera matrix under one of the names in use.
bool HasCameraMatrix(const CalibrationEntries& entries);

// Messages do not name the file.
Result<CameraFile> CameraFromOpenCv(const CalibrationEntries& entries, const CameraFileOptions& options);

// Nothing where the entries have no second camera matrix.
Result<std::optional<StereoCalibration>> StereoFromOpenCv(const CalibrationEntries& entries);

}  // namespace pliant
