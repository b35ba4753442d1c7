// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The nearest of some points in the plane, exactly and without a tree: the points are sorted by x, and the search goes
// outwards from a position until x alone is too far. For some hundred points that is faster than one.
#pragma once

#include <compare>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace pliant {

class NearestInPlane {
 public:
  explicit NearestInPlane(std::span<const Eigen::Vector2d> points);

  struct Neighbor {
    double squared_distance;
    std::size_t index;
    auto operator<=>(const Neighbor&) const = default;
  };
  // The `count` points nearest to a position that are at least `min_distance` away from it, nearest first; at equal
  // distance in the order of their index; fewer where there are not as many.
  std::vector<Neighbor> To(const Eigen::Vector2d& position, std::size_t count, double min_distance = 0) const;
  // The same of one of the points, without itself.
  std::vector<Neighbor> ToPoint(std::size_t index, std::size_t count) const;

 private:
  std::vector<Neighbor> Search(const Eigen::Vector2d& position, std::size_t count, double min_distance,
                               std::size_t without) const;

  std::vector<Eigen::Vector2d> points_;
  std::vector<std::size_t> order_;  // by x
};

}  // namespace pliant
