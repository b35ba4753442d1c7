// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Decompositions of small matrices, each compiled once: a file that instantiates Eigen's own takes 5 to 10 seconds more
// to compile. The results are Eigen's, bit for bit. Nothing fails; of a matrix that is not finite the result means
// nothing.
#pragma once

#include <Eigen/Core>

namespace pliant {

// A = vectors * diag(values) * vectors'.
template <int N>
struct SymmetricEigen {
  Eigen::Matrix<double, N, 1> values;   // increasing
  Eigen::Matrix<double, N, N> vectors;  // columns of unit length, in the order of the values
};

// Of a symmetric matrix; only its lower triangle is read.
SymmetricEigen<2> EigenOfSymmetric(const Eigen::Matrix2d& matrix);
SymmetricEigen<3> EigenOfSymmetric(const Eigen::Matrix3d& matrix);
SymmetricEigen<6> EigenOfSymmetric(const Eigen::Matrix<double, 6, 6>& matrix);
SymmetricEigen<9> EigenOfSymmetric(const Eigen::Matrix<double, 9, 9>& matrix);
SymmetricEigen<Eigen::Dynamic> EigenOfSymmetric(const Eigen::MatrixXd& matrix);

// A = u * diag(singular_values) * v'.
struct Svd3 {
  Eigen::Matrix3d u;
  Eigen::Vector3d singular_values;  // decreasing
  Eigen::Matrix3d v;
};
Svd3 SvdOf(const Eigen::Matrix3d& matrix);

// The unit vector x of the smallest |matrix * x|, of either sign.
Eigen::Vector4d SmallestRightSingularVector(const Eigen::Matrix<double, 6, 4>& matrix);

}  // namespace pliant
