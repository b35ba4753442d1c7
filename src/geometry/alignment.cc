// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/geometry/alignment.h"

#include <Eigen/Dense>

namespace pliant {

Result<Sim3> AlignPoints(std::span<const Eigen::Vector3d> a, std::span<const Eigen::Vector3d> b, AlignmentScale scale) {
  assert(a.size() == b.size());
  if (a.size() < 3) return Status(ErrorCode::kInsufficient, "aligning two point sets takes at least three points");

  const auto n = static_cast<Eigen::Index>(a.size());
  const Eigen::Map<const Eigen::Matrix3Xd> points_a(a.front().data(), 3, n);
  const Eigen::Map<const Eigen::Matrix3Xd> points_b(b.front().data(), 3, n);
  const Eigen::Vector3d mean_a = points_a.rowwise().mean();
  const Eigen::Vector3d mean_b = points_b.rowwise().mean();
  const double spread_a = (points_a.colwise() - mean_a).squaredNorm();
  const double spread_b = (points_b.colwise() - mean_b).squaredNorm();
  const double tiny = 1e-24 * (mean_a.squaredNorm() + mean_b.squaredNorm());
  if (!(spread_a > tiny && spread_b > tiny))
    return Status(ErrorCode::kDegenerate, "the points to align all coincide, or are not numbers");

  const Eigen::Matrix4d m = Eigen::umeyama(points_a, points_b, scale == AlignmentScale::kEstimated);
  Sim3 b_from_a;
  b_from_a.scale = scale == AlignmentScale::kEstimated ? m.topLeftCorner<3, 1>().norm() : 1.0;
  b_from_a.rotation = Eigen::Quaterniond(Eigen::Matrix3d(m.topLeftCorner<3, 3>() / b_from_a.scale)).normalized();
  b_from_a.translation = m.topRightCorner<3, 1>();
  return b_from_a;
}

}  // namespace pliant
