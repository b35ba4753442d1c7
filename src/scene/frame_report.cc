// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/scene/frame_report.h"

#include "pliant/base/statistics.h"

namespace pliant {

std::string AdviceOnUncertainDepth(double median_parallax_deg, CameraOrigin camera_origin) {
  if (median_parallax_deg < kEnoughParallaxDeg) return "move the camera sideways or forwards";
  return std::string(camera_origin == CameraOrigin::kAssumed
                         ? "the assumed field of view may be wrong: calibrate or assume another"
                         : "parallax is not what is missing: check the calibration") +
         ", mask what moves by itself (tools), or choose a part with sharper images or slower deformation";
}

std::optional<double> ReprojectionErrorPx(const Camera& camera, const Rigid3& cam_from_world,
                                          const PointObservation& observation) {
  const auto pixel = camera.Project(cam_from_world * observation.position);
  if (!pixel) return std::nullopt;
  return (*pixel - observation.pixel).norm();
}

double MedianReprojectionErrorPx(const Camera& camera, const Rigid3& cam_from_world,
                                 const std::vector<PointObservation>& observations) {
  std::vector<double> errors_px;
  for (const PointObservation& observation : observations)
    if (const auto error_px = ReprojectionErrorPx(camera, cam_from_world, observation)) errors_px.push_back(*error_px);
  return errors_px.empty() ? 0.0 : Median(std::move(errors_px));
}

}  // namespace pliant
