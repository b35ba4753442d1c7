// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Semi-global matching (Hirschmueller, PAMI 2008): costs of discrete levels, made smooth along eight directions.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace pliant {

// Costs of `levels` levels a pixel, those of a pixel side by side, at most kLargestCost.
struct CostVolume {
  static constexpr int kLargestCost = 1000;

  CostVolume(cv::Size s, int n)
      : size(s), levels(n), costs(static_cast<std::size_t>(s.area()) * static_cast<std::size_t>(n)) {}
  std::int16_t* At(int x, int y) { return costs.data() + Offset(x, y); }
  const std::int16_t* At(int x, int y) const { return costs.data() + Offset(x, y); }

  cv::Size size;
  int levels;
  std::vector<std::int16_t> costs;

 private:
  std::size_t Offset(int x, int y) const {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) + static_cast<std::size_t>(x)) *
           static_cast<std::size_t>(levels);
  }
};

// (V6) The sum of the smoothed costs over the directions. `small_step` is what neighboring pixels pay for a difference
// of one level, `large_step` for any larger one; both at most kLargestCost.
CostVolume SmoothCosts(const CostVolume& costs, int small_step, int large_step, int threads);

}  // namespace pliant
