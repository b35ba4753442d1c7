// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/sfm_error.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/seen_points.h"
#include "geometry/nearest_pixels.h"

namespace pliant {
namespace {

constexpr std::size_t kNeighbors = 3;
constexpr double kNearest_px = 2;  // keeps the weight of a point at the very pixel finite

// The depths of one frame's reconstructed points between their pixels.
class SfmDepths {
 public:
  SfmDepths(const std::vector<SfmPoint>& points, int width_px, const SfmErrorOptions& options)
      : points_(points),
        options_(options),
        nearest_px_(options.max_distance * width_px),
        nearest_(PixelsOf(points), std::max(options.max_distance, options.max_third_distance) * width_px),
        third_px_(options.max_third_distance * width_px) {}

  std::optional<double> At(const Eigen::Vector2d& pixel) const {
    auto neighbors = nearest_.Find(pixel, kNeighbors);
    if (neighbors.empty() || neighbors.front().distance_px > nearest_px_) return std::nullopt;
    if (neighbors.size() < kNeighbors || neighbors.back().distance_px > third_px_) neighbors.resize(1);
    double weights = 0;
    double weighted = 0;
    double sum = 0;
    double low = points_[neighbors.front().idx].depth;
    double high = low;
    for (const auto& [distance_px, idx] : neighbors) {
      const double depth = points_[idx].depth;
      const double weight = 1 / (distance_px + kNearest_px);
      weights += weight;
      weighted += weight * depth;
      sum += depth;
      low = std::min(low, depth);
      high = std::max(high, depth);
    }
    if (high - low > options_.max_depth_step * sum / static_cast<double>(neighbors.size())) return std::nullopt;
    return weighted / weights;
  }

 private:
  static std::vector<Eigen::Vector2d> PixelsOf(const std::vector<SfmPoint>& points) {
    std::vector<Eigen::Vector2d> pixels;
    for (const SfmPoint& point : points) pixels.push_back(point.pixel);
    return pixels;
  }

  const std::vector<SfmPoint>& points_;
  const SfmErrorOptions& options_;
  double nearest_px_;
  NearestPixels nearest_;
  double third_px_;
};

}  // namespace

void SfmErrorOptions::List(OptionTable& table) {
  table.Add("max_distance", &max_distance, "of the image's width", "from a point to the nearest reconstructed one",
            0.0001, 1.0);
  table.Add("max_third_distance", &max_third_distance, "of the image's width",
            "to the third nearest, up to which the three are averaged; else the nearest alone is taken", 0.0001, 1.0);
  table.Add("max_depth_step", &max_depth_step, "of the mean", "among the depths that are averaged; more is an edge",
            0.0, 10.0);
  table.Add("min_points", &min_points, "points", "compared in a frame that counts", 1, 1000000);
}

Result<RelativeDepthError> ComputeSfmError(const EvaluationInput& run, const SfmPoints& sfm, int width_px,
                                           const SfmErrorOptions& options) {
  std::vector<RelativeDepthFrame> frames;
  int common = 0;
  for (const EvaluationFrame& frame : run.frames) {
    const auto known = sfm.find(frame.frame_idx);
    if (!frame.cam_from_world || known == sfm.end()) continue;
    ++common;
    const SfmDepths depths(known->second, width_px, options);
    const SeenPoints points = SeenPointsOf(frame);
    std::vector<DepthPair> pairs;
    for (std::size_t i = 0; i < points.pixels.size(); ++i)
      if (const auto depth = depths.At(points.pixels[i])) pairs.push_back({points.depths[i], *depth});
    if (static_cast<int>(pairs.size()) >= options.min_points)
      frames.push_back(CompareDepths(frame.frame_idx, pairs, NullDepths::kOfOther));
  }
  return Summarize(std::move(frames), "of the " + std::to_string(common) +
                                          " tracked frames with points of structure from motion none has " +
                                          std::to_string(options.min_points) + " points near them");
}

}  // namespace pliant
