// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/relocalization/submap_merging.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

constexpr std::size_t kNearest = 8;     // landmarks that tell the depth of a pixel
constexpr double kFarthestShare = 0.1;  // of the image's width, they are away from it
constexpr double kNear = 0.01;          // squared share of that: nearer ones count alike
constexpr double kFlat = 0.1;           // weight of a zero gradient, relative to a landmark's at that distance
// Pixels that must tell the unit: where maps overlap by an edge alone, what is beside it says little.
constexpr std::size_t kMinRatios = 30;

// A pixel of the image, and how far from the camera what it shows is.
struct PixelDistance {
  Eigen::Vector2d pixel;
  double distance;
};

// The logarithm of the distance at a pixel, from the nearest of those that are known: of the plane through them, over
// the image, the nearer the more, as the wall is seen aslant. Nothing where there are none.
std::optional<double> LogDistanceAt(const Eigen::Vector2d& pixel, std::vector<PixelDistance>& known, double radius_px) {
  const auto nearer = [&](const PixelDistance& a, const PixelDistance& b) {
    return (a.pixel - pixel).squaredNorm() < (b.pixel - pixel).squaredNorm();
  };
  if (known.size() < kNearest) return std::nullopt;
  std::partial_sort(known.begin(), known.begin() + kNearest, known.end(), nearer);
  Eigen::Matrix3d normal = Eigen::Vector3d(0, kFlat, kFlat).asDiagonal();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < kNearest; ++k) {
    const Eigen::Vector2d offset = (known[k].pixel - pixel) / radius_px;
    if (offset.squaredNorm() > 1) return std::nullopt;
    const Eigen::Vector3d row(1, offset.x(), offset.y());
    const double weight = 1 / (kNear + offset.squaredNorm());
    normal += weight * row * row.transpose();
    right += weight * std::log(known[k].distance) * row;
  }
  return normal.ldlt().solve(right).x();
}

// How many of the first one's units one of the second's is: the median over the first one's pixels. Nothing where too
// few pixels tell it, or where they differ too much.
std::optional<double> UnitRatio(const std::vector<PixelDistance>& first, std::vector<PixelDistance> second,
                                double radius_px, double max_spread) {
  std::vector<double> logs;
  for (const PixelDistance& point : first)
    if (const auto log_distance = LogDistanceAt(point.pixel, second, radius_px))
      logs.push_back(std::log(point.distance) - *log_distance);
  if (logs.size() < kMinRatios) return std::nullopt;
  if (MedianDeviation(logs) > max_spread) return std::nullopt;
  return std::exp(Median(std::move(logs)));
}

}  // namespace

std::optional<Sim3> InactiveFromCurrent(const FollowedPoints& inactive, const Submap& current, int image_width,
                                        double max_unit_spread) {
  std::vector<PixelDistance> in_inactive;
  for (std::size_t k = 0; k < inactive.size(); ++k)
    in_inactive.push_back({inactive.pixels[k], (inactive.cam_from_world * inactive.positions[k]).norm()});
  std::vector<PixelDistance> in_current;
  for (const Landmark& landmark : current.map.landmarks)
    in_current.push_back({landmark.pixel, (current.last_cam_from_world * landmark.position).norm()});
  const auto unit = UnitRatio(in_inactive, std::move(in_current), kFarthestShare * image_width, max_unit_spread);
  if (!unit) return std::nullopt;
  return WorldFromPoses(inactive.cam_from_world, current.last_cam_from_world, *unit);
}

}  // namespace pliant
