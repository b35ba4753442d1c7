// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The nearest of many pixels, within a radius.
#pragma once

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace pliant {

class NearestPixels {
 public:
  // Finite pixels; a radius above 0.
  NearestPixels(std::vector<Eigen::Vector2d> pixels, double radius_px);

  struct Neighbor {
    double distance_px = 0;
    std::size_t idx = 0;
  };
  // The at most `count` nearest ones within the radius, nearest first; of equally near ones the earlier.
  std::vector<Neighbor> Find(const Eigen::Vector2d& pixel, std::size_t count) const;

 private:
  using Cell = std::pair<long, long>;
  Cell CellOf(const Eigen::Vector2d& pixel) const;

  std::vector<Eigen::Vector2d> pixels_;
  double radius_px_;
  std::map<Cell, std::vector<std::size_t>> cells_;  // as wide as the radius
};

}  // namespace pliant
