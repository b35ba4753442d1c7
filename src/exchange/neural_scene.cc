// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "exchange/neural_scene.h"

#include <cmath>
#include <vector>

#include "pliant/base/statistics.h"
#include "pliant/base/text.h"

namespace pliant {

Eigen::Matrix<double, 3, 4> OpenGlWorldFromCam(const Rigid3& cam_from_world, double unit) {
  Eigen::Matrix<double, 3, 4> pose;
  pose.leftCols<3>() = cam_from_world.RotationMatrix().transpose() * Eigen::Vector3d(1, -1, -1).asDiagonal();
  pose.col(3) = cam_from_world.OriginInSource() / unit;
  return pose;
}

std::vector<double> DepthsOf(const Rigid3& cam_from_world, const std::vector<PointObservation>& observations) {
  std::vector<double> depths;
  for (const PointObservation& o : observations)
    if (const double z = (cam_from_world * o.position).z(); z > 0.0) depths.push_back(z);
  return depths;
}

Result<double> TypicalDepth(const RunSource& source) {
  std::vector<double> medians;
  const Status status = ForEachFrame(source, [&](const SourceFrame& frame, const auto& observations) {
    const std::vector<double> depths = DepthsOf(frame.cam_from_world, observations);
    if (!depths.empty()) medians.push_back(Median(depths));
    return Status::Ok();
  });
  if (!status.ok()) return status;
  if (medians.empty())
    return Status(ErrorCode::kInsufficient, "no frame of the run " + Quoted(source.run_path) +
                                                " has a point in front of its camera, so its scale is not known");
  return Median(medians);
}

double PowerOfTenUpTo(double length) { return std::pow(10.0, std::floor(std::log10(length))); }

}  // namespace pliant
