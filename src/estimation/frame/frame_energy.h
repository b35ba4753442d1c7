// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The energy of the joint problem and its gradient, in the variables that suit a solver best: the points' positions in
// the CAMERA frame and the pose's increment (docs/method.md, eq. E10). With
//   e_i = x_i - (Exp(omega) R0 (X_i - pivot) + R0 pivot + t0 + tau),
// the displacement delta_i seen from the camera, all norms are those of the world frame, and
//   E_rep = f(x_i) alone,   E_tmp = f(e_i),   E_spa = f(e_i - e_j),   E_len = f(x_i - x_j).
// The stiff reprojection term thus couples no two variables of different points, and the pose takes no part in it.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "estimation/frame/frame_data.h"
#include "estimation/frame/frame_terms.h"

namespace pliant {

class FrameEnergy {
 public:
  // `data` and `terms` must outlive this.
  FrameEnergy(const FrameData& data, const FrameTerms& terms);

  // The energy at `points_in_cam` (N, mm) and `increment`; its gradient by them into `by_points` (N) and
  // `by_increment`. False where a point leaves the camera's domain.
  bool Evaluate(const std::vector<Eigen::Vector3d>& points_in_cam, const Vector6d& increment, double* energy,
                std::vector<Eigen::Vector3d>* by_points, Vector6d* by_increment);

 private:
  const FrameData& data_;
  const FrameTerms& terms_;
  std::vector<Eigen::Vector3d> arms_;  // R0 (X_i - pivot)
  // Working memory of an evaluation.
  std::vector<Eigen::Vector3d> rotated_arms_;
  std::vector<Eigen::Vector3d> displacements_;     // e_i
  std::vector<Eigen::Vector3d> by_displacements_;  // dE / de_i
};

}  // namespace pliant
