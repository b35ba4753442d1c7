// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/reprojection_error.h"

#include <vector>

#include "pliant/base/statistics.h"

namespace pliant {

std::optional<ReprojectionError> ComputeReprojectionError(const EvaluationInput& run, const Camera& camera) {
  std::vector<double> errors_px;
  for (const EvaluationFrame& frame : run.frames) {
    if (!frame.cam_from_world) continue;
    for (const PointObservation& observation : frame.observations)
      if (const auto error_px = ReprojectionErrorPx(camera, *frame.cam_from_world, observation))
        errors_px.push_back(*error_px);
  }
  if (errors_px.empty()) return std::nullopt;
  ReprojectionError error;
  error.points = static_cast<std::int64_t>(errors_px.size());
  error.rmse_px = Rms(errors_px);
  error.median_px = Median(std::move(errors_px));
  return error;
}

}  // namespace pliant
