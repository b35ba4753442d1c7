// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What a calibration file says of a sequence besides the camera; filled from io's reader in open_sequence.cc.
#pragma once

#include <filesystem>

#include "pliant/camera/camera.h"

namespace pliant {

struct SourceCalibration {
  Camera camera;
  std::filesystem::path path;  // for messages
  double fps = 30.0;           // of sources that carry no time of their own
  double depth_scale = 1.0;    // mm a unit of the depth images
};

}  // namespace pliant
