// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/point_colors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/statistics.h"
#include "pliant/image/brightness.h"

namespace pliant {
namespace {

constexpr std::size_t kMinPoints = 40;   // of a frame
constexpr double kMinSpread_levels = 3;  // of their colors: imported points may all be gray
constexpr double kBeside = 1.0 / 200;    // of the image's width, at least ...
constexpr double kMinBeside_px = 4;      // ... so many pixels
constexpr double kMinOtherRatio = 0.9;   // of images that were tracked it is 0.1 to 0.8, of others 0.95 to 1.05

double LevelOf(const std::array<std::uint8_t, 3>& rgb) { return (rgb[0] + rgb[1] + rgb[2]) / 3.0; }

}  // namespace

void PointColors::Compare(std::span<const PointObservation> observations, const cv::Mat& image) {
  std::vector<Eigen::Vector2d> pixels;
  std::vector<double> levels;
  for (const PointObservation& seen : observations) {
    if (!seen_.insert(seen.id).second) continue;
    const auto point = known_.points.find(seen.id);
    if (point == known_.points.end()) continue;
    pixels.push_back(seen.pixel);
    levels.push_back(LevelOf(point->second.rgb));
  }
  if (pixels.size() < kMinPoints || MedianDeviation(levels) < kMinSpread_levels) return;
  // The sum over the points; the light as a whole may have changed since.
  const auto distance_at = [&](const Eigen::Vector2d& offset) {
    std::vector<double> differences;
    for (std::size_t k = 0; k < pixels.size(); ++k) {
      const Eigen::Vector2d last(image.cols - 1, image.rows - 1);
      const Eigen::Vector2d pixel = (pixels[k] + offset).cwiseMax(0).cwiseMin(last);
      differences.push_back(LevelOf(ColorAt(image, pixel)) - levels[k]);
    }
    const double light = Median(differences);
    double sum = 0;
    for (const double difference : differences) sum += std::abs(difference - light);
    return sum;
  };
  const double px = std::max(kMinBeside_px, kBeside * image.cols);
  at_ += distance_at(Eigen::Vector2d::Zero());
  for (const auto& [x, y] : {std::pair(px, 0.0), std::pair(-px, 0.0), std::pair(0.0, px), std::pair(0.0, -px)})
    beside_ += 0.25 * distance_at({x, y});
}

bool PointColors::AreOfOtherImages() const { return beside_ > 0 && at_ > kMinOtherRatio * beside_; }

}  // namespace pliant
