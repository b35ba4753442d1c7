// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/frame/frame_preconditioner.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "pliant/residuals/reprojection.h"

namespace pliant {
namespace {

using Points = std::vector<Eigen::Vector3d>;

FrameStiffness StiffnessOf(const FrameTerms& terms, const Points& points) {
  FrameStiffness stiffness;
  stiffness.of_points.assign(points.size(), 0.0);
  for (const auto& term : terms) term->AddStiffness(points, &stiffness);
  return stiffness;
}

// The regularizers' own 3x3 block of every point.
std::vector<Eigen::Matrix3d> PointBlocks(const FrameData& data, const FrameStiffness& stiffness) {
  std::vector<Eigen::Matrix3d> blocks;
  blocks.reserve(stiffness.of_points.size());
  for (const double of_point : stiffness.of_points) blocks.push_back(of_point * Eigen::Matrix3d::Identity());
  for (std::size_t k = 0; k < data.edges.size(); ++k) {
    Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
    for (const std::vector<EdgeStiffness>& of_edges : stiffness.of_edges) {
      const EdgeStiffness& edge = of_edges[k];
      if (edge.of_positions > 0.0) block += edge.of_positions * edge.u * edge.u.transpose();
      block.diagonal().array() += edge.of_displacements;
    }
    blocks[data.edges[k].i] += block;
    blocks[data.edges[k].j] += block;
  }
  return blocks;
}

}  // namespace

FramePreconditioner::FramePreconditioner(const FrameData& data, const FrameTerms& terms, const Points& start)
    : data_(data), start_(start) {
  for (const Eigen::Vector3d& point : start_) rays_.push_back(point.normalized());
  const FrameStiffness stiffness = StiffnessOf(terms, start_);
  const std::vector<Eigen::Matrix3d> blocks = PointBlocks(data_, stiffness);
  BuildAcross(blocks);
  ok_ = BuildAlong(blocks, stiffness) && BuildPose(stiffness);
  scratch_.resize(data_.num_points());
}

// C: the reprojection term's Hessian and the regularizers' blocks, across each ray.
void FramePreconditioner::BuildAcross(const std::vector<Eigen::Matrix3d>& blocks) {
  across_.resize(start_.size());
  data_.camera->Visit([&]<class Model>(const Model& model) {
    const ReprojectionKernel<Model> kernel(model, data_.options.sigma_rep_px);
    Eigen::Vector2d residual;
    ReprojectionJacobian jacobian;
    for (int i = 0; i < data_.num_points(); ++i) {
      Across directions;
      directions.col(0) = rays_[i].unitOrthogonal();
      directions.col(1) = rays_[i].cross(directions.col(0));
      Eigen::Matrix2d block = directions.transpose() * blocks[i] * directions;
      if (kernel.ResidualAndJacobian(data_.pixels[i], start_[i], &residual, &jacobian)) {
        const Eigen::Matrix2d by_directions = jacobian * directions;
        block += by_directions.transpose() * by_directions;
      }
      // block = l l': across = directions * l^-T.
      const Eigen::Matrix2d l = block.llt().matrixL();
      across_[i].col(0) = directions.col(0) / l(0, 0);
      across_[i].col(1) = (directions.col(1) - across_[i].col(0) * l(1, 0)) / l(1, 1);
    }
  });
}

// A: the regularizers along the rays.
bool FramePreconditioner::BuildAlong(const std::vector<Eigen::Matrix3d>& blocks, const FrameStiffness& stiffness) {
  const int num_points = data_.num_points();
  Eigen::SparseMatrix<double> matrix(num_points, num_points);
  // Edges are sorted by (i, j), i < j: the lower triangle's columns in order, without a sort.
  matrix.reserve(num_points + static_cast<int>(data_.edges.size()));
  std::size_t k = 0;
  for (int i = 0; i < num_points; ++i) {
    matrix.startVec(i);
    matrix.insertBack(i, i) = rays_[i].dot(blocks[i] * rays_[i]);
    for (; k < data_.edges.size() && data_.edges[k].i == i; ++k) {
      const Eigen::Vector3d& ray_j = rays_[data_.edges[k].j];
      double coupling = 0;
      for (const std::vector<EdgeStiffness>& of_edges : stiffness.of_edges) {
        const EdgeStiffness& edge = of_edges[k];
        coupling -= edge.of_displacements * rays_[i].dot(ray_j);
        if (edge.of_positions > 0.0) coupling -= edge.of_positions * rays_[i].dot(edge.u) * ray_j.dot(edge.u);
      }
      matrix.insertBack(data_.edges[k].j, i) = coupling;
    }
  }
  matrix.finalize();
  along_.compute(matrix);
  return along_.info() == Eigen::Success;
}

// B and P. A motion (omega, tau) of the camera moves e_i by v_i x omega - tau, v_i = R0 (X_i - pivot). With
// q_i = a_i v_i + sum_j a_ij (v_i - v_j), a of the displacements, the regularizers' Hessian by (x_i, pose) is
// ([q_i]x, -a_i I).
bool FramePreconditioner::BuildPose(const FrameStiffness& stiffness) {
  const int num_points = data_.num_points();
  Points v(num_points);
  Points q(num_points);
  for (int i = 0; i < num_points; ++i) {
    v[i] = data_.pose.Arm(data_.positions[i]);
    q[i] = stiffness.of_points[i] * v[i];
  }
  for (const std::vector<EdgeStiffness>& of_edges : stiffness.of_edges) {
    for (std::size_t k = 0; k < data_.edges.size(); ++k) {
      const GraphEdge& edge = data_.edges[k];
      const Eigen::Vector3d pull = of_edges[k].of_displacements * (v[edge.i] - v[edge.j]);
      q[edge.i] += pull;
      q[edge.j] -= pull;
    }
  }
  Eigen::Matrix<double, 6, 6> pose = Eigen::Matrix<double, 6, 6>::Zero();
  Pose along(num_points, 6);
  for (int i = 0; i < num_points; ++i) {
    const Eigen::Matrix3d skew_q = Skew(q[i]);
    pose.topLeftCorner<3, 3>() -= Skew(v[i]) * skew_q;
    pose.bottomLeftCorner<3, 3>() -= skew_q;
    pose.bottomRightCorner<3, 3>().diagonal().array() += stiffness.of_points[i];
    along.row(i) << rays_[i].cross(q[i]).transpose(), -stiffness.of_points[i] * rays_[i].transpose();
  }
  coupling_ = along_.permutationP() * along;
  along_.matrixL().solveInPlace(coupling_);
  pose -= coupling_.transpose() * coupling_;  // only the lower triangle is read
  const Eigen::LLT<Eigen::Matrix<double, 6, 6>, Eigen::Lower> factor(pose);
  pose_factor_ = factor.matrixL();
  return factor.info() == Eigen::Success;
}

void FramePreconditioner::ToPoints(const Eigen::Ref<const Eigen::VectorXd>& z, Points* points_in_cam,
                                   Vector6d* increment) const {
  const int num_points = data_.num_points();
  *increment = z.tail<6>();
  pose_factor_.transpose().triangularView<Eigen::Upper>().solveInPlace(*increment);
  scratch_ = z.segment(2 * num_points, num_points);
  scratch_.noalias() -= coupling_ * *increment;
  along_.matrixU().solveInPlace(scratch_);
  const auto& order = along_.permutationP().indices();
  for (int i = 0; i < num_points; ++i)
    (*points_in_cam)[i] = start_[i] + across_[i] * z.segment<2>(2 * i) + rays_[i] * scratch_[order[i]];
}

void FramePreconditioner::ToGradient(const Points& by_points, const Vector6d& by_increment,
                                     Eigen::Ref<Eigen::VectorXd> by_z) const {
  const int num_points = data_.num_points();
  const auto& order = along_.permutationP().indices();
  for (int i = 0; i < num_points; ++i) {
    by_z.segment<2>(2 * i).noalias() = across_[i].transpose() * by_points[i];
    scratch_[order[i]] = rays_[i].dot(by_points[i]);
  }
  along_.matrixL().solveInPlace(scratch_);
  by_z.segment(2 * num_points, num_points) = scratch_;
  Vector6d pose = by_increment - coupling_.transpose() * scratch_;
  pose_factor_.triangularView<Eigen::Lower>().solveInPlace(pose);
  by_z.tail<6>() = pose;
}

}  // namespace pliant
