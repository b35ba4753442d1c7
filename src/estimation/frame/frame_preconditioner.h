// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Variables in which the joint problem's Hessian is nearly the identity (docs/method.md, eq. E11).
//
// In the camera frame (frame_energy.h) the reprojection term holds each point across its ray, a hundred times more
// strongly than the regularizers hold anything, and does not hold it along its ray at all. So the Hessian is nearly
//   [ C 0 0 ; 0 A B ; 0 B' P ]   by (across the rays, along the rays, pose):
// C has 2x2 blocks, A is a sparse matrix with ONE row a point, P is 6x6. This matrix M = L L' is cheap to factorise
// (27 times fewer operations than with three rows a point), and
//   (points - start, increment) = Q L^-T z,   dE/dz = L^-1 Q' dE/d(points, increment),
// with Q the turn into the rays' frames. What M leaves out only costs iterations, never exactness.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCholesky>

#include "estimation/frame/frame_data.h"
#include "estimation/frame/frame_terms.h"

namespace pliant {

class FramePreconditioner {
 public:
  // M at `start` (points in the camera frame, mm) with the pose's increment zero and no loss active. `data`
  // and `start` must outlive this. ok() is false where M is not positive definite.
  FramePreconditioner(const FrameData& data, const FrameTerms& terms, const std::vector<Eigen::Vector3d>& start);

  bool ok() const { return ok_; }
  int num_variables() const { return 3 * static_cast<int>(start_.size()) + 6; }

  // The points and the increment at z.
  void ToPoints(const Eigen::Ref<const Eigen::VectorXd>& z, std::vector<Eigen::Vector3d>* points_in_cam,
                Vector6d* increment) const;
  // dE/dz from dE/d(points, increment).
  void ToGradient(const std::vector<Eigen::Vector3d>& by_points, const Vector6d& by_increment,
                  Eigen::Ref<Eigen::VectorXd> by_z) const;

 private:
  // Two directions across the ray, the factor of C's block already divided out: across = directions * z_i.
  using Across = Eigen::Matrix<double, 3, 2>;
  using Pose = Eigen::Matrix<double, Eigen::Dynamic, 6>;

  void BuildAcross(const std::vector<Eigen::Matrix3d>& blocks);
  bool BuildAlong(const std::vector<Eigen::Matrix3d>& blocks, const FrameStiffness& stiffness);
  bool BuildPose(const FrameStiffness& stiffness);

  const FrameData& data_;
  const std::vector<Eigen::Vector3d>& start_;
  bool ok_ = false;
  std::vector<Eigen::Vector3d> rays_;  // unit
  std::vector<Across> across_;         // C's part of Q L^-T
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> along_;
  Pose coupling_;                            // W = L_A^-1 B, rows in the order of along_
  Eigen::Matrix<double, 6, 6> pose_factor_;  // lower triangle of P - W' W
  mutable Eigen::VectorXd scratch_;
};

}  // namespace pliant
