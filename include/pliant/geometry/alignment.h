// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Similarity transforms and least-squares alignment of point sets (Umeyama, PAMI 1991).
#pragma once

#include <span>

#include <Eigen/Core>

#include "pliant/base/status.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

// x_in_b = scale * (rotation * x_in_a) + translation.
struct Sim3 {
  double scale = 1.0;
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return scale * (rotation * x) + translation; }
};

enum class AlignmentScale { kEstimated, kFixedAtOne };

// The transform that minimises sum |b_i - (b_from_a * a_i)|^2. Fails with kInsufficient below three points and with
// kDegenerate when all of `a` (or of `b`) coincide. Points on a line are accepted: the error is then still the least
// one, the rotation about the line is arbitrary.
Result<Sim3> AlignPoints(std::span<const Eigen::Vector3d> a, std::span<const Eigen::Vector3d> b, AlignmentScale scale);

}  // namespace pliant
