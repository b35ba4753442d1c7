// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/window/shape_basis.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "estimation/deforming_scene.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using deforming_test::DeformingScene;

constexpr std::size_t kMaxNodes = 4;  // nodes that share a point

TEST(SurfaceNodes, WeightsSumToOneAndANodesOwnPointIsItsAlone) {
  const DeformingScene scene;
  const SurfaceNodes nodes = NodesAt(scene.points, {0, 20, 40, 60, 80, 100, 120});
  const std::vector<NodesOfPoint> around = NodesAround(scene.points, nodes.positions);
  for (const NodesOfPoint& of : around) {
    double sum = 0;
    for (const NodeWeight& weight : of.weights) sum += weight.weight;
    EXPECT_NEAR(sum, 1.0, kRoundOff);
    EXPECT_LE(of.weights.size(), kMaxNodes);
  }
  EXPECT_EQ(around[20].distance, 0.0);
  EXPECT_EQ(around[20].weights.front().node_idx, 1);
  // A linear field's gradient is found.
  SurfaceNodes linear = nodes;
  linear.shapes.resize(3, 7);
  for (Eigen::Index n = 0; n < 7; ++n) linear.shapes.col(n) = 0.5 * linear.positions[static_cast<std::size_t>(n)];
  EXPECT_NEAR(SizesOf(linear).gradient, 0.5 / std::sqrt(3.0), kRoundOff);
}

}  // namespace
}  // namespace pliant
