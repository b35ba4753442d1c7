// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// All that OpenGV does here: motions between two views from samples of their rays, by any of its solvers in its robust
// loops, and its non-linear refinement. Rays are unit vectors, equal in number; motions are cam1_from_cam0 with a
// translation of unit length.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "pliant/base/random.h"
#include "pliant/base/status.h"
#include "pliant/estimation/two_view/relative_pose.h"

namespace pliant {

// Pairs in a sample, of any solver; 0 for one that takes all pairs at once.
int SampleSize(RelativePoseSolver solver);

// The best motion by options.robust over samples of options.solver, one of those through OpenGV; none where no sample
// has a motion.
std::optional<Rigid3> SampleMotion(std::span<const Eigen::Vector3d> rays0, std::span<const Eigen::Vector3d> rays1,
                                   double focal_px, Random random, const RelativePoseOptions& options);

// optimize_nonlinear on all pairs alike. Fails with kDegenerate when it ends without a motion.
Result<Rigid3> RefineMotionByOpengv(const Rigid3& start, std::span<const Eigen::Vector3d> rays0,
                                    std::span<const Eigen::Vector3d> rays1);

}  // namespace pliant
