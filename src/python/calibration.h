// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A calibrated camera as Python has it: pliant.Camera.
#pragma once

#include <optional>

#include "pliant/camera/camera.h"
#include "pliant/camera/photometric_calibration.h"

namespace pliant::python {

struct Calibration {
  Camera camera;
  std::optional<double> fps = std::nullopt;
  std::optional<PhotometricCalibration> photometric = std::nullopt;  // of a camera.yaml
};

}  // namespace pliant::python
