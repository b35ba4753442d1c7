// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/scene/frame_report.h"

#include "pliant/base/statistics.h"

namespace pliant {

std::string AdviceOnUncertainDepth(double median_parallax_deg) {
  if (median_parallax_deg < kEnoughParallaxDeg) return "give more frames, or move the camera sideways or forwards";
  return "parallax is not what is missing: check the calibration, mask what moves by itself (tools), or choose a part "
         "with sharper images, or one in which the scene deforms more slowly than the camera moves";
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
