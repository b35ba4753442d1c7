// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/tracks/nearest_in_plane.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace pliant {

NearestInPlane::NearestInPlane(std::span<const Eigen::Vector2d> points)
    : points_(points.begin(), points.end()), order_(points.size()) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::ranges::sort(order_, {}, [&](std::size_t k) { return std::pair(points_[k].x(), k); });
}

std::vector<NearestInPlane::Neighbor> NearestInPlane::To(const Eigen::Vector2d& position, std::size_t count,
                                                         double min_distance) const {
  return Search(position, count, min_distance, points_.size());
}

std::vector<NearestInPlane::Neighbor> NearestInPlane::ToPoint(std::size_t index, std::size_t count) const {
  return Search(points_[index], count, 0, index);
}

std::vector<NearestInPlane::Neighbor> NearestInPlane::Search(const Eigen::Vector2d& position, std::size_t count,
                                                             double min_distance, std::size_t without) const {
  std::vector<Neighbor> best;
  if (count == 0) return best;
  best.reserve(count + 1);
  // Whether points farther along x than this one may still be nearer.
  const auto visit = [&](std::size_t index) {
    const Eigen::Vector2d offset = points_[index] - position;
    if (best.size() == count && offset.x() * offset.x() > best.back().squared_distance) return false;
    const Neighbor neighbor{offset.squaredNorm(), index};
    if (index == without || neighbor.squared_distance < min_distance * min_distance) return true;
    if (best.size() == count && neighbor > best.back()) return true;
    best.insert(std::ranges::upper_bound(best, neighbor), neighbor);
    if (best.size() > count) best.pop_back();
    return true;
  };
  const auto begin = std::ranges::lower_bound(order_, position.x(), {}, [&](std::size_t k) { return points_[k].x(); });
  auto right = begin;
  auto left = begin;
  for (bool goes_left = true, goes_right = true; goes_left || goes_right;) {
    goes_left = goes_left && left != order_.begin() && visit(*--left);
    goes_right = goes_right && right != order_.end() && visit(*right++);
  }
  return best;
}

}  // namespace pliant
