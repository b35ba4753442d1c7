// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "surface/level_choice.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "pliant/base/parallel.h"
#include "surface/semi_global.h"

namespace pliant {
namespace {

// Of costs from 0 to kLargestCost.
constexpr int kSmallStep = 30;
constexpr int kLargeStep = 300;
constexpr int kCurvatureReach = 2;  // levels to either side

CostVolume VolumeOf(const std::vector<cv::Mat>& costs, int half, double center_weight, int threads) {
  CostVolume volume(costs.front().size(), static_cast<int>(costs.size()));
  ParallelFor(volume.size.height, threads, [&](int y) {
    for (int k = 0; k < volume.levels; ++k) {
      const double share = static_cast<double>(k - half) / half;
      const auto bias = static_cast<float>(center_weight * share * share);
      const auto* cost = costs[static_cast<std::size_t>(k)].ptr<float>(y);
      for (int x = 0; x < volume.size.width; ++x)
        volume.At(x, y)[k] = static_cast<std::int16_t>(CostVolume::kLargestCost * std::min(1.0F, cost[x] + bias));
    }
  });
  return volume;
}

// Where a parabola through three values has its least one, -0.5 to 0.5 from the middle one.
template <class T>
float ParabolaMinimum(T before, T here, T after) {
  const auto curvature = static_cast<float>(before) - 2.0F * static_cast<float>(here) + static_cast<float>(after);
  if (!(curvature > 0.0F)) return 0.0F;
  return std::clamp(0.5F * (static_cast<float>(before) - static_cast<float>(after)) / curvature, -0.5F, 0.5F);
}

// Of the parabola through the cost of a level that fits those around it best.
template <class Costs>
float Curvature(const Costs& at, int level, int reach) {
  float sum = 0.0F;
  float weights = 0.0F;
  for (int k = -reach; k <= reach; ++k) {
    const auto square = static_cast<float>(k * k);
    sum += square * (at(level + k) - at(level));
    weights += square * square;
  }
  return weights > 0.0F ? 2.0F * sum / weights : 0.0F;
}

}  // namespace

ChosenLevels ChooseLevels(const std::vector<cv::Mat>& costs, int half, double center_weight, int threads) {
  const CostVolume smooth = SmoothCosts(VolumeOf(costs, half, center_weight, threads), kSmallStep, kLargeStep, threads);
  const cv::Size size = smooth.size;
  ChosenLevels chosen{cv::Mat(size, CV_32F), cv::Mat(size, CV_8U), cv::Mat(size, CV_32F), cv::Mat(size, CV_32F)};
  ParallelFor(size.height, threads, [&](int y) {
    for (int x = 0; x < size.width; ++x) {
      const std::int16_t* cost = smooth.At(x, y);
      const auto best = static_cast<int>(std::min_element(cost, cost + smooth.levels) - cost);
      const bool at_end = best == 0 || best + 1 == smooth.levels;
      chosen.at_end.at<std::uint8_t>(y, x) = at_end ? 255 : 0;
      const float fraction = at_end ? 0.0F : ParabolaMinimum(cost[best - 1], cost[best], cost[best + 1]);
      chosen.level.at<float>(y, x) = static_cast<float>(best - half) + fraction;
      const auto at = [&](int k) { return costs[static_cast<std::size_t>(k)].at<float>(y, x); };
      chosen.cost.at<float>(y, x) = at(best);
      const int reach = std::min({kCurvatureReach, best, smooth.levels - 1 - best});
      chosen.curvature.at<float>(y, x) = Curvature(at, best, reach);
    }
  });
  return chosen;
}

}  // namespace pliant
