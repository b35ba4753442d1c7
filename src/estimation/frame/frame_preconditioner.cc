// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/frame/frame_preconditioner.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "pliant/residuals/edge_length.h"
#include "pliant/residuals/reprojection.h"
#include "pliant/residuals/spatial.h"
#include "pliant/residuals/temporal.h"

namespace pliant {
namespace {

using Points = std::vector<Eigen::Vector3d>;

// Second derivatives of the pair terms of one edge: spatial * I + length * u u'.
struct EdgeStiffness {
  double spatial;
  double length;
  Eigen::Vector3d u;
};

EdgeStiffness StiffnessOf(const FrameProblemOptions& options, const GraphEdge& edge, const Points& points) {
  const double scale = SpatialKernel(edge.weight, options.sigma_spa_mm).scale();
  EdgeStiffness stiffness{options.lambda_spa * edge.multiplicity * scale * scale, 0.0, Eigen::Vector3d::Zero()};
  if (options.edge_length == Switch::kOn) {
    stiffness.u = EdgeLengthKernel(edge.rest_length_mm, options.sigma_len_mm).Jacobian(points[edge.i], points[edge.j]);
    stiffness.length = options.lambda_len * edge.multiplicity;
  }
  return stiffness;
}

double TemporalStiffness(const FrameProblemOptions& options) {
  const double scale = TemporalKernel(options.sigma_tmp_mm).scale();
  return options.lambda_tmp * scale * scale;
}

// The regularizers' own 3x3 block of every point.
std::vector<Eigen::Matrix3d> PointStiffness(const FrameTerms& terms, const Points& points) {
  const Eigen::Matrix3d temporal = TemporalStiffness(terms.options) * Eigen::Matrix3d::Identity();
  std::vector<Eigen::Matrix3d> blocks(points.size(), temporal);
  for (const GraphEdge& edge : terms.edges) {
    const EdgeStiffness stiffness = StiffnessOf(terms.options, edge, points);
    Eigen::Matrix3d block = stiffness.length * stiffness.u * stiffness.u.transpose();
    block.diagonal().array() += stiffness.spatial;
    blocks[edge.i] += block;
    blocks[edge.j] += block;
  }
  return blocks;
}

}  // namespace

FramePreconditioner::FramePreconditioner(const FrameTerms& terms, const Points& start) : terms_(terms), start_(start) {
  for (const Eigen::Vector3d& point : start_) rays_.push_back(point.normalized());
  const std::vector<Eigen::Matrix3d> stiffness = PointStiffness(terms_, start_);
  BuildAcross(stiffness);
  ok_ = BuildAlong(stiffness) && BuildPose();
  scratch_.resize(terms_.num_points());
}

// C: the reprojection term's curvature and the regularizers' own, across each ray.
void FramePreconditioner::BuildAcross(const std::vector<Eigen::Matrix3d>& stiffness) {
  across_.resize(start_.size());
  terms_.camera->Visit([&]<class Model>(const Model& model) {
    const ReprojectionKernel<Model> kernel(model, terms_.options.sigma_rep_px);
    Eigen::Vector2d residual;
    ReprojectionJacobian jacobian;
    for (int i = 0; i < terms_.num_points(); ++i) {
      Across directions;
      directions.col(0) = rays_[i].unitOrthogonal();
      directions.col(1) = rays_[i].cross(directions.col(0));
      Eigen::Matrix2d block = directions.transpose() * stiffness[i] * directions;
      if (kernel.ResidualAndJacobian(terms_.pixels[i], start_[i], &residual, &jacobian)) {
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
bool FramePreconditioner::BuildAlong(const std::vector<Eigen::Matrix3d>& stiffness) {
  const int num_points = terms_.num_points();
  Eigen::SparseMatrix<double> matrix(num_points, num_points);
  // Edges are sorted by (i, j), i < j: the lower triangle's columns in order, without a sort.
  matrix.reserve(num_points + static_cast<int>(terms_.edges.size()));
  auto edge = terms_.edges.begin();
  for (int i = 0; i < num_points; ++i) {
    matrix.startVec(i);
    matrix.insertBack(i, i) = rays_[i].dot(stiffness[i] * rays_[i]);
    for (; edge != terms_.edges.end() && edge->i == i; ++edge) {
      const EdgeStiffness pair = StiffnessOf(terms_.options, *edge, start_);
      matrix.insertBack(edge->j, i) = -pair.spatial * rays_[i].dot(rays_[edge->j]) -
                                      pair.length * rays_[i].dot(pair.u) * rays_[edge->j].dot(pair.u);
    }
  }
  matrix.finalize();
  along_.compute(matrix);
  return along_.info() == Eigen::Success;
}

// B and P. A motion (omega, tau) of the camera moves e_i by v_i x omega - tau, v_i = R0 (X_i - pivot). With
// q_i = a_tmp v_i + sum_j a_ij (v_i - v_j), the regularizers' Hessian by (x_i, pose) is ([q_i]x, -a_tmp I).
bool FramePreconditioner::BuildPose() {
  const int num_points = terms_.num_points();
  const double temporal = TemporalStiffness(terms_.options);
  Points v(num_points);
  Points q(num_points);
  for (int i = 0; i < num_points; ++i) {
    v[i] = terms_.pose.Arm(terms_.positions[i]);
    q[i] = temporal * v[i];
  }
  for (const GraphEdge& edge : terms_.edges) {
    const double scale = SpatialKernel(edge.weight, terms_.options.sigma_spa_mm).scale();
    const Eigen::Vector3d pull =
        terms_.options.lambda_spa * edge.multiplicity * scale * scale * (v[edge.i] - v[edge.j]);
    q[edge.i] += pull;
    q[edge.j] -= pull;
  }
  Eigen::Matrix<double, 6, 6> pose = Eigen::Matrix<double, 6, 6>::Zero();
  Pose along(num_points, 6);
  for (int i = 0; i < num_points; ++i) {
    const Eigen::Matrix3d skew_q = Skew(q[i]);
    pose.topLeftCorner<3, 3>() -= Skew(v[i]) * skew_q;
    pose.bottomLeftCorner<3, 3>() -= skew_q;
    pose.bottomRightCorner<3, 3>().diagonal().array() += temporal;
    along.row(i) << rays_[i].cross(q[i]).transpose(), -temporal * rays_[i].transpose();
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
  const int num_points = terms_.num_points();
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
  const int num_points = terms_.num_points();
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
