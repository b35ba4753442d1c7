// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "refinement/residual_correlation.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "pliant/base/statistics.h"
#include "pliant/estimation/window/window_refinement.h"

namespace pliant {
namespace {

constexpr std::size_t kViews = 64;
constexpr std::size_t kNeighbors = 4;
constexpr double kCut = 4.0;  // times the median error, which one error counts at most

}  // namespace

double ResidualCorrelation(const Recording& recording, const std::vector<bool>& used,
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
  double products = 0;
  double squares = 0;
  for (const std::size_t view : SpreadViews(of_view.size(), kViews)) {
    for (const std::size_t a : of_view[view]) {
      std::vector<std::pair<double, std::size_t>> near;
      for (const std::size_t b : of_view[view]) {
        const double distance = (recording.observations[a].pixel - recording.observations[b].pixel).norm();
        if (distance >= min_distance_px) near.emplace_back(distance, b);
      }
      const std::size_t count = std::min(kNeighbors, near.size());
      std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
      for (std::size_t k = 0; k < count; ++k) {
        products += error(a).dot(error(near[k].second));
        squares += 0.5 * (error(a).squaredNorm() + error(near[k].second).squaredNorm());
      }
    }
  }
  return squares > 0.0 ? products / squares : 0.0;
}

}  // namespace pliant
