// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/frame/frame_energy.h"

#include <algorithm>

namespace pliant {

using Points = std::vector<Eigen::Vector3d>;

FrameEnergy::FrameEnergy(const FrameData& data, const FrameTerms& terms)
    : data_(data),
      terms_(terms),
      rotated_arms_(data.positions.size()),
      displacements_(data.positions.size()),
      by_displacements_(data.positions.size()) {
  arms_.reserve(data.positions.size());
  for (const Eigen::Vector3d& position : data.positions) arms_.push_back(data.pose.Arm(position));
}

bool FrameEnergy::Evaluate(const Points& points_in_cam, const Vector6d& increment, double* energy, Points* by_points,
                           Vector6d* by_increment) {
  const Eigen::Vector3d omega = increment.head<3>();
  const Eigen::Vector3d origin = data_.pose.pivot_in_cam() + increment.tail<3>();
  Eigen::Matrix3d rotation;
  for (int c = 0; c < 3; ++c) rotation.col(c) = RotateByExp<double>(omega, Eigen::Vector3d::Unit(c));
  const int num_points = data_.num_points();
  for (int i = 0; i < num_points; ++i) {
    rotated_arms_[i].noalias() = rotation * arms_[i];
    displacements_[i] = points_in_cam[i] - rotated_arms_[i] - origin;
  }

  *energy = 0;
  std::fill(by_points->begin(), by_points->end(), Eigen::Vector3d::Zero());
  std::fill(by_displacements_.begin(), by_displacements_.end(), Eigen::Vector3d::Zero());
  Eigen::Vector3d by_rotation = Eigen::Vector3d::Zero();
  const FrameVariables at{points_in_cam, displacements_, rotation};
  FrameGradient gradient{*by_points, by_displacements_, by_rotation};
  for (const auto& term : terms_)
    if (!term->AddPointEnergy(at, energy, gradient)) return false;
  for (const auto& term : terms_) term->AddEdgeEnergy(at, energy, gradient);

  // A rotation by phi moves e_i by -phi x rotated_arm_i, a translation by -tau.
  Eigen::Vector3d by_translation = Eigen::Vector3d::Zero();
  for (int i = 0; i < num_points; ++i) {
    (*by_points)[i] += by_displacements_[i];
    by_rotation -= rotated_arms_[i].cross(by_displacements_[i]);
    by_translation -= by_displacements_[i];
  }
  by_increment->head<3>() = LeftJacobian(omega).transpose() * by_rotation;
  by_increment->tail<3>() = by_translation;
  return true;
}

}  // namespace pliant
