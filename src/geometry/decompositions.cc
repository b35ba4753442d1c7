// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/geometry/decompositions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace pliant {
namespace {

template <int N>
SymmetricEigen<N> Decompose(const Eigen::Matrix<double, N, N>& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace

SymmetricEigen<2> EigenOfSymmetric(const Eigen::Matrix2d& matrix) { return Decompose<2>(matrix); }
SymmetricEigen<3> EigenOfSymmetric(const Eigen::Matrix3d& matrix) { return Decompose<3>(matrix); }
SymmetricEigen<6> EigenOfSymmetric(const Eigen::Matrix<double, 6, 6>& matrix) { return Decompose<6>(matrix); }
SymmetricEigen<9> EigenOfSymmetric(const Eigen::Matrix<double, 9, 9>& matrix) { return Decompose<9>(matrix); }
SymmetricEigen<Eigen::Dynamic> EigenOfSymmetric(const Eigen::MatrixXd& matrix) {
  return Decompose<Eigen::Dynamic>(matrix);
}

Svd3 SvdOf(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

Eigen::Vector4d SmallestRightSingularVector(const Eigen::Matrix<double, 6, 4>& matrix) {
  return Eigen::JacobiSVD<Eigen::Matrix<double, 6, 4>>(matrix, Eigen::ComputeFullV).matrixV().col(3);
}

}  // namespace pliant
