// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/camera/assumed_camera.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

#include "pliant/base/options.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

constexpr std::string_view kPrefix = "fov:";
constexpr double kNarrowest_deg = 10;
constexpr double kWidest_deg = 150;

}  // namespace

std::string AssumedCameraName(double horizontal_fov_deg) {
  return std::string(kPrefix) + FormatDouble(horizontal_fov_deg);
}

bool IsAssumedCamera(const std::string& camera_path) { return camera_path.starts_with(kPrefix); }

CameraOrigin OriginOf(const std::string& camera_path) {
  return IsAssumedCamera(camera_path) ? CameraOrigin::kAssumed : CameraOrigin::kGiven;
}

Result<Camera> MakeAssumedCamera(const std::string& name, int width, int height) {
  double fov_deg = 0;
  const bool is_number = IsAssumedCamera(name) && ParseFinite(std::string_view(name).substr(kPrefix.size()), &fov_deg);
  if (!is_number || fov_deg < kNarrowest_deg || fov_deg > kWidest_deg)
    return Status(ErrorCode::kInvalidArgument,
                  "the camera " + Quoted(name) + " is no field of view; give 10 to 150 degrees, such as fov:70");
  const double focal_px = 0.5 * width / std::tan(fov_deg * std::numbers::pi / 360.0);
  return Camera::Create(CameraModelId::kSimplePinhole, width, height,
                        std::array{focal_px, 0.5 * (width - 1), 0.5 * (height - 1)});
}

}  // namespace pliant
