// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/map_upkeep/common_motion.h"

#include <Eigen/Dense>

namespace pliant {

Rigid3 CommonMotionToRest(const Map& map, double share) {
  // Landmarks in a row hardly turn about it.
  constexpr double kDamping = 0.01;
  const auto count = static_cast<double>(map.landmarks.size());
  if (count < 3) return {};
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  for (const Landmark& landmark : map.landmarks) {
    mean += landmark.position / count;
    shift += (landmark.rest_position - landmark.position) / count;
  }
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (const Landmark& landmark : map.landmarks) {
    const Eigen::Vector3d arm = landmark.position - mean;
    inertia += arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose();
    moment += arm.cross(landmark.rest_position - landmark.position);
  }
  inertia.diagonal().array() += kDamping * inertia.trace();
  if (!(inertia.trace() > 0)) return {};
  const Eigen::Quaterniond turn = RotationExp(share * inertia.ldlt().solve(moment));
  return {turn, mean + share * shift - turn * mean};
}

}  // namespace pliant
