// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A camera of which nothing is known but about how wide it sees. SequenceRequest::camera_path names it in place of a
// file: "fov:70".
#pragma once

#include <string>
#include <string_view>

#include "pliant/base/status.h"
#include "pliant/camera/camera.h"

namespace pliant {

enum class CameraOrigin {
  kGiven,    // a calibration, right or wrong
  kAssumed,  // a field of view alone
};

// The name of a camera with this horizontal field of view, degrees.
std::string AssumedCameraName(double horizontal_fov_deg);
bool IsAssumedCamera(const std::string& camera_path);
CameraOrigin OriginOf(const std::string& camera_path);

// How the warning of a data set begins whose camera is assumed.
inline constexpr std::string_view kAssumedCameraWarning = "the camera is not calibrated";

// SIMPLE_PINHOLE with the optical axis in the middle of the image. Fails with kInvalidArgument unless the name says a
// field of view of 10 to 150 degrees.
Result<Camera> MakeAssumedCamera(const std::string& name, int width, int height);

}  // namespace pliant
