// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "refinement/residual_correlation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pliant/base/statistics.h"
#include "pliant/deformation/graph.h"
#include "pliant/estimation/window/window_refinement.h"

namespace pliant {
namespace {

constexpr std::size_t kViews = 64;
constexpr int kNeighbors = 4;
constexpr double kCut = 4.0;  // times the median error, which one error counts at most

}  // namespace

NeighborCorrelation ResidualCorrelation(const Recording& recording, const std::vector<bool>& used,
                                        const std::vector<Eigen::Vector2d>& errors_px, double min_distance_px) {
  std::vector<std::vector<std::size_t>> of_view(recording.times.size());
  std::vector<double> lengths;
  for (std::size_t o = 0; o < used.size(); ++o) {
    if (!used[o]) continue;
    of_view[static_cast<std::size_t>(recording.observations[o].view_idx)].push_back(o);
    lengths.push_back(errors_px[o].norm());
  }
  const double cut = kCut * Median(lengths);
  const auto error = [&](std::size_t o) {
    return Eigen::Vector2d(errors_px[o] * std::min(1.0, cut / std::max(1e-12, errors_px[o].norm())));
  };
  std::erase_if(of_view, [](const std::vector<std::size_t>& seen) { return seen.empty(); });
  if (of_view.size() < 2) return {};
  double products = 0;
  double squares = 0;
  double pairs = 0;
  for (const std::size_t view : SpreadViews(of_view.size(), kViews)) {
    const std::vector<std::size_t>& seen = of_view[view];
    std::vector<Eigen::Vector3d> pixels;
    for (const std::size_t o : seen) pixels.push_back(recording.observations[o].pixel.homogeneous());
    const NeighborLists neighbors = NearestNeighborsApart(pixels, min_distance_px, kNeighbors);
    for (std::size_t a = 0; a < seen.size(); ++a)
      for (const int b : neighbors[a]) {
        const Eigen::Vector2d error_a = error(seen[a]);
        const Eigen::Vector2d error_b = error(seen[static_cast<std::size_t>(b)]);
        products += error_a.dot(error_b);
        ++pairs;
        squares += 0.5 * (error_a.squaredNorm() + error_b.squaredNorm());
      }
  }
  if (!(squares > 0.0)) return {};
  return {products / squares, 1.0 / std::sqrt(pairs)};
}

}  // namespace pliant
