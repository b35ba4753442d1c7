// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/depth_prior/prior_distances.h"

#include <cmath>
#include <limits>
#include <vector>

#include "pliant/image/depth_lookup.h"
#include "tracking/depth_prior/scale_and_shift.h"

namespace pliant {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

}  // namespace

PriorDistances::Value PriorDistances::ValueAt(const Eigen::Vector2d& pixel) const {
  if (frame_.depth_prior.empty()) return {kNone, kNone};
  const cv::Mat& prior = frame_.depth_prior;
  const Eigen::Array2d scale(static_cast<double>(prior.cols) / camera_.width(),
                             static_cast<double>(prior.rows) / camera_.height());
  const Eigen::Vector2d in_prior = (pixel.array() + 0.5) * scale - 0.5;  // (0, 0) is the center of its first pixel too
  const DepthAtPixel at = LookUpDepth(prior, in_prior, options_.max_step);
  if (at.lookup != DepthLookup::kOk) return {kNone, kNone};
  const auto ray = camera_.Unproject(pixel);
  if (!ray || !(ray->z() > 0.0)) return {kNone, kNone};
  return {at.depth_mm, ray->z() / ray->norm()};
}

double PriorDistances::LogAt(const Eigen::Vector2d& pixel) const {
  const Value at = ValueAt(pixel);
  const double aligned = scale_ * at.value + shift_;
  if (!(aligned > 0.0)) return kNone;
  const double log_depth = options_.kind == DepthPriorKind::kDepth ? std::log(aligned) : -std::log(aligned);
  return log_depth - std::log(at.cosine);
}

bool PriorDistances::AlignTo(const Map& map, const Rigid3& cam_from_world) {
  std::vector<Eigen::Vector2d> pixels;
  std::vector<double> distances;
  for (const Landmark& landmark : map.landmarks) {
    pixels.push_back(landmark.pixel);
    distances.push_back((cam_from_world * landmark.position).norm());
  }
  return AlignTo(pixels, distances);
}

bool PriorDistances::AlignTo(std::span<const Eigen::Vector2d> pixels, std::span<const double> distances) {
  std::vector<double> values;
  std::vector<double> targets;
  for (std::size_t k = 0; k < pixels.size(); ++k) {
    const Value at = ValueAt(pixels[k]);
    const double depth = distances[k] * at.cosine;
    if (!(depth > 0.0)) continue;
    values.push_back(at.value);
    targets.push_back(options_.kind == DepthPriorKind::kDepth ? depth : 1.0 / depth);
  }
  const auto fit = FitScaleAndShift(values, targets);
  if (!fit) return false;
  scale_ = fit->scale;
  shift_ = fit->shift;
  return true;
}

}  // namespace pliant
