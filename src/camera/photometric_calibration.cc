// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/camera/photometric_calibration.h"

#include <cmath>
#include <limits>

namespace pliant {

Status CheckPhotometric(const PhotometricCalibration& calibration) {
  if (!(calibration.gamma >= 0.1 && calibration.gamma <= 10.0))
    return {ErrorCode::kInvalidArgument, "gamma must be between 0.1 and 10"};
  if (!(calibration.vignetting >= 0.0 && calibration.vignetting <= 100.0))
    return {ErrorCode::kInvalidArgument, "vignetting, the exponent of a cosine, must be between 0 and 100"};
  if (!(calibration.light_spread >= 0.0 && calibration.light_spread <= 100.0))
    return {ErrorCode::kInvalidArgument, "light_spread must be between 0 and 100"};
  const double length = calibration.light_axis.norm();
  if (!(length > 0.0 && std::isfinite(length)))
    return {ErrorCode::kInvalidArgument, "light_axis must be a direction, three numbers of which one is not 0"};
  return Status::Ok();
}

double LogFalloff(const PhotometricCalibration& calibration, const Eigen::Vector3d& ray) {
  const Eigen::Vector3d direction = ray.normalized();
  double log_share = -calibration.light_spread * (1.0 - direction.dot(calibration.light_axis.normalized()));
  if (calibration.vignetting > 0.0) {
    if (!(direction.z() > 0.0)) return std::numeric_limits<double>::quiet_NaN();
    log_share += calibration.vignetting * std::log(direction.z());
  }
  return log_share;
}

double LogDistanceFromLight(const PhotometricCalibration& calibration, double brightness, const Eigen::Vector3d& ray) {
  if (!(brightness > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  return 0.5 * (LogFalloff(calibration, ray) - calibration.gamma * std::log(brightness / 255.0));
}

}  // namespace pliant
