// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "geometry/nearest_pixels.h"

#include <algorithm>
#include <cmath>

namespace pliant {

NearestPixels::NearestPixels(std::vector<Eigen::Vector2d> pixels, double radius_px)
    : pixels_(std::move(pixels)), radius_px_(radius_px) {
  for (std::size_t i = 0; i < pixels_.size(); ++i) cells_[CellOf(pixels_[i])].push_back(i);
}

NearestPixels::Cell NearestPixels::CellOf(const Eigen::Vector2d& pixel) const {
  return {std::lround(std::floor(pixel.x() / radius_px_)), std::lround(std::floor(pixel.y() / radius_px_))};
}

std::vector<NearestPixels::Neighbor> NearestPixels::Find(const Eigen::Vector2d& pixel, std::size_t count) const {
  std::vector<Neighbor> found;
  const auto [column, row] = CellOf(pixel);
  for (long x = column - 1; x <= column + 1; ++x) {
    for (long y = row - 1; y <= row + 1; ++y) {
      const auto cell = cells_.find({x, y});
      if (cell == cells_.end()) continue;
      for (const std::size_t idx : cell->second) {
        const double distance_px = (pixels_[idx] - pixel).norm();
        if (distance_px <= radius_px_) found.push_back({distance_px, idx});
      }
    }
  }
  std::sort(found.begin(), found.end(), [](const Neighbor& a, const Neighbor& b) {
    return std::pair(a.distance_px, a.idx) < std::pair(b.distance_px, b.idx);
  });
  if (found.size() > count) found.resize(count);
  return found;
}

}  // namespace pliant
