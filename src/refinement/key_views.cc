// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "refinement/key_views.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

constexpr int kMinViews = 3;   // of a point that has a part in a solution
constexpr int kMinPoints = 4;  // of a view that has: fewer do not determine its pose

std::vector<int> CountPoints(const Recording& recording, const std::vector<bool>& used) {
  std::vector<int> counts(recording.times.size(), 0);
  for (std::size_t o = 0; o < used.size(); ++o)
    if (used[o]) ++counts[static_cast<std::size_t>(recording.observations[o].view_idx)];
  return counts;
}

std::vector<std::size_t> ViewsWith(const Recording& recording, const std::vector<bool>& used) {
  const std::vector<int> points = CountPoints(recording, used);
  std::vector<std::size_t> views;
  for (std::size_t v = 0; v < points.size(); ++v)
    if (points[v] > 0) views.push_back(v);
  return views;
}

}  // namespace

int StrideOfKeyViews(const Recording& recording, const std::vector<bool>& used, int views_per_track) {
  const std::vector<int> views = CountViews(recording, used);
  std::vector<double> views_of_track;  // an observation each
  for (const RecordedObservation& o : recording.observations)
    views_of_track.push_back(views[static_cast<std::size_t>(o.point_idx)]);
  return std::max(1, static_cast<int>(std::lround(Median(views_of_track) / views_per_track)));
}

std::vector<bool> UsedInKeyViews(const Recording& recording, const std::vector<bool>& used, int stride) {
  if (stride == 1) return used;
  std::vector<bool> in_key_views = used;
  const int first = std::max(0, recording.measured_view_idx) % stride;
  for (std::size_t o = 0; o < used.size(); ++o)
    in_key_views[o] = used[o] && recording.observations[o].view_idx % stride == first;
  KeepDetermined(recording, &in_key_views);
  return in_key_views;
}

void KeepDetermined(const Recording& recording, std::vector<bool>* used) {
  for (bool has_changed = true; has_changed;) {
    const std::vector<int> views = CountViews(recording, *used);
    const std::vector<int> points = CountPoints(recording, *used);
    has_changed = false;
    for (std::size_t o = 0; o < used->size(); ++o) {
      const RecordedObservation& seen = recording.observations[o];
      if (!(*used)[o] || (views[static_cast<std::size_t>(seen.point_idx)] >= kMinViews &&
                          points[static_cast<std::size_t>(seen.view_idx)] >= kMinPoints))
        continue;
      (*used)[o] = false;
      has_changed = true;
    }
  }
}

void InterpolateViews(const Recording& recording, const std::vector<bool>& used, BundleState* state) {
  const std::vector<std::size_t> keys = ViewsWith(recording, used);
  if (keys.empty()) return;
  // From the solution's world to the recording's, about a key view.
  const auto change = [&](std::size_t key) {
    return recording.cams_from_world[key].Inverse() * state->cams_from_world[key];
  };
  for (std::size_t v = 0; v < recording.times.size(); ++v) {
    const auto next = std::ranges::lower_bound(keys, v);
    if (next != keys.end() && *next == v) continue;
    const std::size_t after = next == keys.end() ? keys.back() : *next;
    const std::size_t before = next == keys.begin() ? keys.front() : *std::prev(next);
    const double share = before == after ? 0.0
                                         : (recording.times[v] - recording.times[before]) /
                                               (recording.times[after] - recording.times[before]);
    state->cams_from_world[v] = recording.cams_from_world[v] * Interpolated(change(before), change(after), share);
    if (state->rank() > 0)
      state->coefficients.col(static_cast<Eigen::Index>(v)) =
          (1.0 - share) * state->coefficients.col(static_cast<Eigen::Index>(before)) +
          share * state->coefficients.col(static_cast<Eigen::Index>(after));
  }
}

}  // namespace pliant
