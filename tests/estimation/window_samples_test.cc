// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/window/window_samples.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "support/tolerances.h"

namespace pliant {
namespace {

constexpr int kMinOnTheLeft = 15;  // of 100: a quarter of the image, not half of the sample as of the points
constexpr int kMaxOnTheLeft = 40;
constexpr double kOwnWeight = 0.8;         // of a point that is where one of the nearest is
constexpr double kBetweenNeighbors = 0.6;  // of values from -3 to 3, which change by about that between samples

// A grid of rays; three times as many points in its left quarter as elsewhere.
DeformingWindow Grid() {
  DeformingWindow window;
  window.times = {0, 5};
  window.cams_from_world = {Rigid3(), Rigid3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0, 0, -2))};
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x)
      for (int copy = 0; copy < (x < 5 ? 3 : 1); ++copy)
        window.points_in_world.emplace_back(50 * Eigen::Vector3d(0.04 * x - 0.4, 0.04 * y - 0.4 + 0.01 * copy, 1));
  for (int v = 0; v < 2; ++v)
    for (int i = 0; i < static_cast<int>(window.points_in_world.size()); ++i)
      window.observations.push_back(
          {v, i,
           (window.cams_from_world[static_cast<std::size_t>(v)] * window.points_in_world[static_cast<std::size_t>(i)])
               .normalized()});
  return window;
}

TEST(WindowSamples, AreTwoWithoutCommonPointsSpreadOverTheImage) {
  const DeformingWindow window = Grid();
  const auto samples = SamplePoints(window, 100);
  ASSERT_EQ(samples.size(), 2U);
  std::set<int> all;
  for (const PointSample& sample : samples) {
    EXPECT_EQ(sample.size(), 100U);
    EXPECT_TRUE(std::is_sorted(sample.begin(), sample.end()));
    all.insert(sample.begin(), sample.end());
    const auto left = std::count_if(sample.begin(), sample.end(), [&](int i) {
      return window.points_in_world[static_cast<std::size_t>(i)].x() < 50 * (0.04 * 5 - 0.4) - 1;
    });
    EXPECT_GT(left, kMinOnTheLeft);
    EXPECT_LT(left, kMaxOnTheLeft);
  }
  EXPECT_EQ(all.size(), 200U);
}

TEST(WindowSamples, NearestPointsHaveWeightsThatSumToOne) {
  const std::vector<Eigen::Vector3d> directions = DirectionsOf(Grid().points_in_world);
  const auto nearest = NearestPoints(directions, directions[123]);
  ASSERT_EQ(nearest.size(), 4U);
  EXPECT_EQ(nearest.front().idx, 123U);
  double sum = 0;
  for (const NearPoint& near : nearest) sum += near.weight;
  EXPECT_NEAR(sum, 1, kRoundOff);
  EXPECT_GT(nearest.front().weight, kOwnWeight);
  EXPECT_EQ(NearestPoints({Eigen::Vector3d::UnitX()}, Eigen::Vector3d::UnitZ()).front().weight, 1);
}

TEST(WindowSamples, SomeViewsAreTheFirstTheLastAndThoseBetween) {
  DeformingWindow window;
  window.coefficients.resize(2, 9);
  for (int v = 0; v < 9; ++v) {
    window.times.push_back(5 * v);
    window.cams_from_world.emplace_back(Eigen::Quaterniond::Identity(), Eigen::Vector3d(v, 0, 0));
    window.coefficients.col(v).setConstant(v);
    window.observations.push_back({v, 0, Eigen::Vector3d::UnitZ()});
  }
  window.points_in_world.emplace_back(0, 0, 50);
  const DeformingWindow some = InSomeViews(window, 3);
  EXPECT_EQ(some.times, (std::vector<double>{0, 20, 40}));
  ASSERT_EQ(some.observations.size(), 3U);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(some.observations[static_cast<std::size_t>(k)].view_idx, k);
    EXPECT_EQ(some.cams_from_world[static_cast<std::size_t>(k)].translation.x(), 4 * k);
    EXPECT_EQ(some.coefficients(1, k), 4 * k);
  }
  EXPECT_EQ(InSomeViews(window, 20).times.size(), 9U);
}

TEST(WindowSamples, FewPointsAreOneSample) {
  DeformingWindow window = Grid();
  window.points_in_world.resize(100);
  const auto samples = SamplePoints(window, 150);
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_EQ(samples.front().size(), 100U);
  window.points_in_world.resize(20);
  EXPECT_EQ(SamplePoints(window, 150).front().size(), 20U);
}

TEST(WindowSamples, NoPointIsChosenTwiceWhereAllAreInOneDirection) {
  DeformingWindow window = Grid();
  for (Eigen::Vector3d& point : window.points_in_world) point = Eigen::Vector3d(0, 0, 50);
  const auto samples = SamplePoints(window, 100);
  ASSERT_FALSE(samples.empty());
  for (const PointSample& sample : samples) EXPECT_EQ(std::set<int>(sample.begin(), sample.end()).size(), 100U);
}

TEST(WindowSamples, APartHasItsPointsObservations) {
  const DeformingWindow window = Grid();
  const DeformingWindow part = PartOf(window, {3, 7, 100});
  ASSERT_EQ(part.points_in_world.size(), 3U);
  EXPECT_EQ(part.points_in_world[0], window.points_in_world[3]);
  EXPECT_EQ(part.points_in_world[2], window.points_in_world[100]);
  ASSERT_EQ(part.observations.size(), 6U);
  for (const DeformingObservation& seen : part.observations)
    EXPECT_LT((seen.ray - (part.cams_from_world[static_cast<std::size_t>(seen.view_idx)] *
                           part.points_in_world[static_cast<std::size_t>(seen.point_idx)])
                              .normalized())
                  .norm(),
              kRoundOff);
}

TEST(WindowSamples, TheOthersMoveLikeTheirNeighbors) {
  const DeformingWindow start = Grid();
  const PointSample sample = SamplePoints(start, 100).front();
  DeformingWindow solved = PartOf(start, sample);
  solved.coefficients = Eigen::MatrixXd::Zero(1, 2);
  solved.coefficients(0, 1) = 1;
  solved.cams_from_world[1].translation.z() = -3;
  for (Eigen::Vector3d& point : solved.points_in_world) {
    point *= 1.5;  // the sample's depths grew by half, and it moves to the right the more the further up
    solved.shapes.emplace_back(Eigen::Vector3d(point.y() / 10, 0, 0));
  }
  const DeformingWindow all = ExtendToAll(start, solved, sample);
  EXPECT_EQ(all.coefficients, solved.coefficients);
  EXPECT_EQ(all.cams_from_world[1].translation.z(), -3);
  EXPECT_EQ(all.observations.size(), start.observations.size());
  for (std::size_t k = 0; k < sample.size(); ++k) {
    EXPECT_EQ(all.points_in_world[static_cast<std::size_t>(sample[k])], solved.points_in_world[k]);
    EXPECT_EQ(all.shapes[static_cast<std::size_t>(sample[k])], solved.shapes[k]);
  }
  for (std::size_t i = 0; i < start.points_in_world.size(); ++i) {
    EXPECT_LT((all.points_in_world[i] - 1.5 * start.points_in_world[i]).norm(), kLengthRoundOff_mm);
    EXPECT_NEAR(all.shapes[i](0, 0), 1.5 * start.points_in_world[i].y() / 10, kBetweenNeighbors);
  }
}

}  // namespace
}  // namespace pliant
