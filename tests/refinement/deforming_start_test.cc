// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>

#include <gtest/gtest.h>

#include "pliant/base/statistics.h"
#include "refinement/bundle.h"
#include "refinement/recorded_scene.h"

namespace pliant {
namespace {

using refinement_test::RecordedScene;

constexpr double kLowRankError = 0.05;  // of the amplitude: a wave is of rank two, and no point is seen all the time
constexpr double kUnitSize = 1e-6;
constexpr int kStartRank = 3;
constexpr int kNodesInView = 12;

TEST(DeformingStart, ExplainsTheMotionsByFewShapes) {
  const RecordedScene scene;
  const Recording recording = scene.Start();
  const BundleState state = DeformingStart(recording, kStartRank, kNodesInView);
  std::vector<double> errors;
  for (const RecordedObservation& o : recording.observations)
    errors.push_back((state.Position(o.point_idx, o.view_idx) - o.position).norm());
  EXPECT_LT(Median(errors), kLowRankError * scene.amplitude_mm);
}

TEST(DeformingStart, ItsCoefficientsAreOfUnitSize) {
  const BundleState state = DeformingStart(RecordedScene().Start(), kStartRank, kNodesInView);
  for (int r = 0; r < state.rank(); ++r)
    EXPECT_NEAR(state.coefficients.row(r).squaredNorm() / static_cast<double>(state.coefficients.cols()), 1.0,
                kUnitSize);
}

TEST(DeformingStart, HasTheNodesOfAMeanView) {
  constexpr int kNeighbors = 6;
  const RecordedScene scene;
  const Recording recording = scene.Start();
  const BundleState state = DeformingStart(recording, kStartRank, kNodesInView);
  const double in_view = static_cast<double>(recording.observations.size()) / scene.views;
  EXPECT_NEAR(static_cast<double>(state.nodes.positions.size()) * in_view / static_cast<double>(scene.points.size()),
              kNodesInView, 1);
  const BundleGraph graph = MakeGraph(state, kNeighbors);
  EXPECT_EQ(graph.nodes_of_point.size(), scene.points.size());
  EXPECT_EQ(graph.edges.size(), state.nodes.positions.size() * static_cast<std::size_t>(kNeighbors));
}

}  // namespace
}  // namespace pliant
