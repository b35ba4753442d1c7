// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Least-squares alignment of point sets (Umeyama, PAMI 1991).
#pragma once

#include <span>

#include <Eigen/Core>

#include "pliant/base/status.h"
#include "pliant/geometry/sim3.h"

namespace pliant {

enum class AlignmentScale { kEstimated, kFixedAtOne };

// The transform that minimizes sum |b_i - (b_from_a * a_i)|^2. Fails with kInsufficient below three points and with
// kDegenerate when all of `a` (or of `b`) coincide. Points on a line are accepted: the error is then still the least
// one, the rotation about the line is arbitrary.
Result<Sim3> AlignPoints(std::span<const Eigen::Vector3d> a, std::span<const Eigen::Vector3d> b, AlignmentScale scale);

}  // namespace pliant
