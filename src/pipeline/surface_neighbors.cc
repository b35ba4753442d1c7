// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/surface_neighbors.h"

#include <algorithm>
#include <cmath>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

struct Overlap {
  double common_share = 0;  // of the reference's points
  double parallax_deg = 0;  // median
};

// The angle of a point between the two cameras, where it was in the reference: what moved does not count.
Overlap OverlapOf(const PosedFrame& reference, const PosedFrame& other) {
  const Eigen::Vector3d here = reference.cam_from_world.OriginInSource();
  const Eigen::Vector3d there = other.cam_from_world.OriginInSource();
  std::vector<double> angles;
  for (const PointObservation& observation : reference.observations) {
    if (FindById(other.observations, observation.id) == nullptr) continue;
    const Eigen::Vector3d a = observation.position - here;
    const Eigen::Vector3d b = observation.position - there;
    angles.push_back(kDegPerRad * std::atan2(a.cross(b).norm(), a.dot(b)));
  }
  if (angles.empty()) return {};
  return {static_cast<double>(angles.size()) / static_cast<double>(reference.observations.size()), Median(angles)};
}

// Of `usable` positions, nearest first, at most `count`, each half as far as the next one, and the last one: near ones
// see most of what the reference sees, far ones tell depths best.
std::vector<std::size_t> Spread(const std::vector<std::size_t>& usable, std::size_t count) {
  std::vector<std::size_t> chosen;
  for (std::size_t left = usable.size(); left > 0 && chosen.size() < count; left = std::min(left - 1, (left + 1) / 2))
    chosen.push_back(usable[left - 1]);
  std::ranges::reverse(chosen);
  return chosen;
}

}  // namespace

std::vector<std::size_t> ChooseNeighbors(std::span<const PosedFrame> frames, std::size_t reference,
                                         const SurfaceRunOptions& options) {
  const auto usable_towards = [&](int direction) {
    std::vector<std::size_t> usable;
    for (auto k = static_cast<std::ptrdiff_t>(reference) + direction;
         k >= 0 && k < static_cast<std::ptrdiff_t>(frames.size()); k += direction) {
      const PosedFrame& other = frames[static_cast<std::size_t>(k)];
      if (other.submap != frames[reference].submap || static_cast<int>(usable.size()) == options.max_frames_apart)
        break;
      const Overlap overlap = OverlapOf(frames[reference], other);
      if (overlap.common_share < options.min_common_points || overlap.parallax_deg > options.max_parallax_deg) break;
      usable.push_back(static_cast<std::size_t>(k));
    }
    return usable;
  };
  const std::vector<std::size_t> before = usable_towards(-1);
  const std::vector<std::size_t> after = usable_towards(1);
  const auto wanted = static_cast<std::size_t>(options.neighbors);
  const std::size_t of_before = std::min(before.size(), std::max(wanted / 2, wanted - std::min(wanted, after.size())));
  const std::vector<std::size_t> first = Spread(before, of_before);
  const std::vector<std::size_t> second = Spread(after, wanted - of_before);
  // Those with an even index, and the others, have both directions and all distances.
  std::vector<std::size_t> chosen = first;
  chosen.insert(chosen.end(), second.rbegin(), second.rend());
  return chosen;
}

}  // namespace pliant
