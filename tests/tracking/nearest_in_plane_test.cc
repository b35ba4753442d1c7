// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/tracks/nearest_in_plane.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "pliant/base/random.h"

namespace pliant {
namespace {

using Neighbor = NearestInPlane::Neighbor;

// On a grid of half pixels, so that many are at the same distance and some at the same place.
std::vector<Eigen::Vector2d> Points(int count) {
  Random random(3);
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < count; ++i)
    points.emplace_back(0.5 * std::floor(random.Uniform(0, 60)), 0.5 * std::floor(random.Uniform(0, 60)));
  return points;
}

std::vector<Neighbor> BySortingAll(const std::vector<Eigen::Vector2d>& points, const Eigen::Vector2d& position,
                                   std::size_t count, double min_distance, std::size_t without) {
  std::vector<Neighbor> all;
  for (std::size_t k = 0; k < points.size(); ++k)
    if (const double squared = (points[k] - position).squaredNorm();
        k != without && squared >= min_distance * min_distance)
      all.push_back({squared, k});
  std::ranges::sort(all);
  all.resize(std::min(all.size(), count));
  return all;
}

TEST(NearestInPlane, FindsWhatSortingAllFinds) {
  const std::vector<Eigen::Vector2d> points = Points(200);
  const NearestInPlane nearest(points);
  for (const std::size_t count : {1U, 8U, 300U})
    for (std::size_t k = 0; k < points.size(); ++k) {
      EXPECT_EQ(nearest.ToPoint(k, count), BySortingAll(points, points[k], count, 0, k));
      const Eigen::Vector2d position = points[k] + Eigen::Vector2d(0.2, -0.1);
      EXPECT_EQ(nearest.To(position, count), BySortingAll(points, position, count, 0, points.size()));
      EXPECT_EQ(nearest.To(position, count, 8), BySortingAll(points, position, count, 8, points.size()));
    }
}

TEST(NearestInPlane, OfNoPointsFindsNone) {
  const NearestInPlane nearest({});
  EXPECT_TRUE(nearest.To({1, 2}, 5).empty());
}

}  // namespace
}  // namespace pliant
