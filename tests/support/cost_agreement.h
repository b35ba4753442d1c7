// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A cost function's analytic Jacobians against automatic derivatives of the formula that its header states.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <ceres/cost_function.h>
#include <ceres/jet.h>
#include <gtest/gtest.h>

namespace pliant {

// Both sides are exact to rounding; entries are compared relative to the largest entry of their Jacobian.
inline constexpr double kAgreement = 1e-12;

inline constexpr int kMaxParameters = 32;
using Jet = ceres::Jet<double, kMaxParameters>;
template <class T>
using Vector2 = Eigen::Matrix<T, 2, 1>;
template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;
template <class T>
using Vector6 = Eigen::Matrix<T, 6, 1>;
using Blocks = std::vector<std::vector<double>>;

// The blocks as jets, numbered through.
inline std::vector<std::vector<Jet>> Variables(const Blocks& blocks) {
  std::vector<std::vector<Jet>> jets;
  int index = 0;
  for (const auto& block : blocks) {
    jets.emplace_back();
    for (const double value : block) jets.back().emplace_back(value, index++);
  }
  return jets;
}

// Residuals and Jacobians of `cost` at `blocks` are those of `expected`.
inline void ExpectAgreement(const ceres::CostFunction& cost, const Blocks& blocks, const std::vector<Jet>& expected) {
  const int rows = static_cast<int>(expected.size());
  ASSERT_EQ(cost.num_residuals(), rows);
  std::vector<const double*> parameters;
  Blocks jacobians;
  std::vector<double*> jacobian_pointers;
  for (const auto& block : blocks) {
    parameters.push_back(block.data());
    jacobians.emplace_back(rows * block.size());
  }
  for (auto& jacobian : jacobians) jacobian_pointers.push_back(jacobian.data());
  std::vector<double> residuals(rows);
  ASSERT_TRUE(cost.Evaluate(parameters.data(), residuals.data(), jacobian_pointers.data()));

  for (int row = 0; row < rows; ++row) {
    EXPECT_NEAR(residuals[row], expected[row].a, kAgreement * std::max(1.0, std::abs(expected[row].a)));
    const double largest = expected[row].v.cwiseAbs().maxCoeff();
    int index = 0;
    for (std::size_t b = 0; b < blocks.size(); ++b)
      for (std::size_t c = 0; c < blocks[b].size(); ++c, ++index)
        EXPECT_NEAR(jacobians[b][row * blocks[b].size() + c], expected[row].v[index], kAgreement * largest)
            << "row " << row << ", block " << b << ", column " << c;
  }
}

}  // namespace pliant
