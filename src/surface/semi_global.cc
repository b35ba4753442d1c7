// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "surface/semi_global.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "pliant/base/parallel.h"

namespace pliant {
namespace {

constexpr std::int16_t kNoLevel = std::numeric_limits<std::int16_t>::max() / 2;

// Along one direction: what each pixel's levels cost, with what came before them on the way.
class Path {
 public:
  Path(int levels, int small_step, int large_step)
      : levels_(levels),
        small_step_(static_cast<std::int16_t>(small_step)),
        large_step_(static_cast<std::int16_t>(large_step)) {}

  // `before` and `now` have a level more at either side. Gives the least of `now`.
  std::int16_t Step(const std::int16_t* cost, const std::int16_t* before, std::int16_t least_before, std::int16_t* now,
                    std::int16_t* sum) const {
    const auto any = static_cast<std::int16_t>(least_before + large_step_);
    std::int16_t least = kNoLevel;
    for (int k = 1; k <= levels_; ++k) {
      const auto beside = static_cast<std::int16_t>(std::min(before[k - 1], before[k + 1]) + small_step_);
      const std::int16_t best = std::min(std::min(before[k], any), beside);
      now[k] = static_cast<std::int16_t>(cost[k - 1] + best - least_before);
      sum[k - 1] = static_cast<std::int16_t>(sum[k - 1] + now[k]);
      least = std::min(least, now[k]);
    }
    now[0] = now[levels_ + 1] = kNoLevel;
    return least;
  }

 private:
  int levels_;
  std::int16_t small_step_;
  std::int16_t large_step_;
};

// Adds the smoothed costs of the direction (dx, dy) to `sum`. Rows follow each other, and pixels of a row in the
// direction of dx.
void AddDirection(const CostVolume& costs, const Path& path, int dx, int dy, CostVolume* sum) {
  const int width = costs.size.width;
  const int height = costs.size.height;
  const auto stride = static_cast<std::size_t>(costs.levels + 2);
  const std::vector<std::int16_t> nothing = [&] {
    std::vector<std::int16_t> zero(stride, 0);
    zero.front() = zero.back() = kNoLevel;
    return zero;
  }();
  struct Row {
    std::vector<std::int16_t> costs;
    std::vector<std::int16_t> least;
  };
  std::array<Row, 2> rows;
  for (Row& row : rows)
    row = {std::vector<std::int16_t>(stride * static_cast<std::size_t>(width)),
           std::vector<std::int16_t>(static_cast<std::size_t>(width))};
  const bool down = dy > 0 || (dy == 0 && dx > 0);
  for (int i = 0; i < height; ++i) {
    const int y = down ? i : height - 1 - i;
    Row& now = rows[static_cast<std::size_t>(i % 2)];
    const Row& before = dy == 0 ? now : rows[static_cast<std::size_t>((i + 1) % 2)];
    for (int j = 0; j < width; ++j) {
      const int x = dx >= 0 ? j : width - 1 - j;
      const int from = x - dx;
      const bool first = from < 0 || from >= width || (dy != 0 && i == 0);
      const auto at = static_cast<std::size_t>(x);
      const auto previous = static_cast<std::size_t>(first ? 0 : from);
      now.least[at] =
          path.Step(costs.At(x, y), first ? nothing.data() : before.costs.data() + stride * previous,
                    first ? std::int16_t{0} : before.least[previous], now.costs.data() + stride * at, sum->At(x, y));
    }
  }
}

}  // namespace

CostVolume SmoothCosts(const CostVolume& costs, int small_step, int large_step, int threads) {
  constexpr std::array<std::array<int, 2>, 4> kDirections = {{{1, 0}, {0, 1}, {1, 1}, {-1, 1}}};
  const Path path(costs.levels, small_step, large_step);
  std::vector<CostVolume> sums(kDirections.size(), CostVolume(costs.size, costs.levels));
  ParallelFor(
      static_cast<int>(kDirections.size()), threads,
      [&](int d) {
        const auto [dx, dy] = kDirections[static_cast<std::size_t>(d)];
        for (const int sign : {1, -1})
          AddDirection(costs, path, sign * dx, sign * dy, &sums[static_cast<std::size_t>(d)]);
      },
      1);
  for (std::size_t d = 1; d < sums.size(); ++d)
    for (std::size_t i = 0; i < sums[0].costs.size(); ++i)
      sums[0].costs[i] = static_cast<std::int16_t>(sums[0].costs[i] + sums[d].costs[i]);
  return std::move(sums[0]);
}

}  // namespace pliant
