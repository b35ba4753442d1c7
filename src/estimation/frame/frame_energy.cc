// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/frame/frame_energy.h"

#include "pliant/residuals/edge_length.h"
#include "pliant/residuals/huber.h"
#include "pliant/residuals/reprojection.h"
#include "pliant/residuals/spatial.h"
#include "pliant/residuals/temporal.h"

namespace pliant {

using Points = std::vector<Eigen::Vector3d>;

FrameEnergy::FrameEnergy(const FrameTerms& terms)
    : terms_(terms),
      rotated_arms_(terms.positions.size()),
      displacements_(terms.positions.size()),
      by_displacements_(terms.positions.size()) {
  arms_.reserve(terms.positions.size());
  for (const Eigen::Vector3d& position : terms.positions) arms_.push_back(terms.pose.Arm(position));
  pairs_.reserve(terms.edges.size());
  for (const GraphEdge& edge : terms.edges)
    pairs_.push_back({edge.i, edge.j, terms.options.lambda_spa * edge.multiplicity,
                      SpatialKernel(edge.weight, terms.options.sigma_spa_mm).scale()});
}

bool FrameEnergy::Evaluate(const Points& points_in_cam, const Vector6d& increment, double* energy, Points* by_points,
                           Vector6d* by_increment) {
  *energy = 0;
  if (!AddReprojection(points_in_cam, energy, by_points)) return false;

  const Eigen::Vector3d omega = increment.head<3>();
  const Eigen::Vector3d origin = terms_.pose.pivot_in_cam() + increment.tail<3>();
  Eigen::Matrix3d rotation;
  for (int c = 0; c < 3; ++c) rotation.col(c) = RotateByExp<double>(omega, Eigen::Vector3d::Unit(c));
  const int num_points = terms_.num_points();
  for (int i = 0; i < num_points; ++i) {
    rotated_arms_[i].noalias() = rotation * arms_[i];
    displacements_[i] = points_in_cam[i] - rotated_arms_[i] - origin;
  }
  *energy += AddTemporal();
  *energy += AddSpatial();
  if (terms_.options.edge_length == Switch::kOn) *energy += AddEdgeLength(points_in_cam, by_points);

  // A rotation by phi moves e_i by -phi x rotated_arm_i, a translation by -tau.
  Eigen::Vector3d by_rotation = Eigen::Vector3d::Zero();
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

// Eq. E1. Writes `by_points`, the others add to it.
bool FrameEnergy::AddReprojection(const Points& points_in_cam, double* energy, Points* by_points) const {
  const FrameProblemOptions& options = terms_.options;
  return terms_.camera->Visit([&]<class Model>(const Model& model) {
    const ReprojectionKernel<Model> kernel(model, options.sigma_rep_px);
    Eigen::Vector2d residual;
    ReprojectionJacobian jacobian;
    double sum = 0;
    for (int i = 0; i < terms_.num_points(); ++i) {
      if (!kernel.ResidualAndJacobian(terms_.pixels[i], points_in_cam[i], &residual, &jacobian)) return false;
      const RobustCost cost = Huber(residual.squaredNorm(), options.chi2_rep);
      sum += cost.rho;
      (*by_points)[i].noalias() = jacobian.transpose() * (cost.slope * residual);
    }
    *energy += 0.5 * sum;
    return true;
  });
}

// Eq. E3. Writes `by_displacements_`, the spatial term adds to it.
double FrameEnergy::AddTemporal() {
  const FrameProblemOptions& options = terms_.options;
  const TemporalKernel kernel(options.sigma_tmp_mm);
  double sum = 0;
  for (int i = 0; i < terms_.num_points(); ++i) {
    const Eigen::Vector3d residual = kernel.Residual<double>(displacements_[i]);
    const RobustCost cost = Huber(residual.squaredNorm(), options.chi2_tmp);
    sum += cost.rho;
    by_displacements_[i] = (options.lambda_tmp * cost.slope * kernel.scale()) * residual;
  }
  return 0.5 * options.lambda_tmp * sum;
}

// Eq. E2. The energy's hot loop; pairs are sorted by i, whose own part stays in registers.
double FrameEnergy::AddSpatial() {
  const double chi2 = terms_.options.chi2_spa;
  double sum = 0;
  for (std::size_t k = 0; k < pairs_.size();) {
    const int i = pairs_[k].i;
    const Eigen::Vector3d e_i = displacements_[i];
    Eigen::Vector3d by_i = Eigen::Vector3d::Zero();
    for (; k < pairs_.size() && pairs_[k].i == i; ++k) {
      const Pair& pair = pairs_[k];
      const Eigen::Vector3d residual = (e_i - displacements_[pair.j]) * pair.scale;
      const RobustCost cost = Huber(residual.squaredNorm(), chi2);
      sum += pair.factor * cost.rho;
      const Eigen::Vector3d gradient = (pair.factor * cost.slope * pair.scale) * residual;
      by_i += gradient;
      by_displacements_[pair.j] -= gradient;
    }
    by_displacements_[i] += by_i;
  }
  return 0.5 * sum;
}

// Eq. E8.
double FrameEnergy::AddEdgeLength(const Points& points_in_cam, Points* by_points) const {
  const FrameProblemOptions& options = terms_.options;
  double sum = 0;
  for (const GraphEdge& edge : terms_.edges) {
    const EdgeLengthKernel kernel(edge.rest_length_mm, options.sigma_len_mm);
    const double residual = kernel.Residual<double>(points_in_cam[edge.i], points_in_cam[edge.j]);
    const RobustCost cost = Huber(residual * residual, options.chi2_len);
    sum += edge.multiplicity * cost.rho;
    const Eigen::Vector3d gradient = (options.lambda_len * edge.multiplicity * cost.slope * residual) *
                                     kernel.Jacobian(points_in_cam[edge.i], points_in_cam[edge.j]);
    (*by_points)[edge.i] += gradient;
    (*by_points)[edge.j] -= gradient;
  }
  return 0.5 * options.lambda_len * sum;
}

}  // namespace pliant
