// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/window/light_depth.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/base/statistics.h"
#include "pliant/geometry/decompositions.h"

namespace pliant {
namespace {

// Brightness goes with cosine / distance^2, so log distance with half of log cosine, whatever the response; wet tissue
// reflects from its coat too, which takes some off.
constexpr double kCosineExponent = 0.4;
constexpr double kMinCosine = 0.12;  // steeper surfaces are not trusted
constexpr double kFar = 1.8;         // times the median distance: beyond, dark noise and the ambient light count
constexpr std::size_t kMinLit = 20;

LightFit FitWithin(double far, const std::vector<double>& distances, const std::vector<double>& log_cue) {
  std::vector<double> offsets;
  std::vector<double> logs;
  for (std::size_t i = 0; i < log_cue.size(); ++i) {
    if (!std::isfinite(log_cue[i]) || !(distances[i] > 0.0) || distances[i] >= far) continue;
    logs.push_back(std::log(distances[i]));
    offsets.push_back(logs.back() - log_cue[i]);
  }
  if (offsets.size() < kMinLit) return {};
  return {MedianDeviation(std::move(offsets)), MedianDeviation(std::move(logs))};
}

}  // namespace

std::vector<double> CorrectForInclination(const std::vector<Eigen::Vector3d>& positions_in_cam,
                                          const NeighborLists& neighbors, const std::vector<double>& log_light) {
  std::vector<double> corrected = log_light;
  for (std::size_t i = 0; i < corrected.size(); ++i) {
    if (!std::isfinite(corrected[i]) || neighbors[i].empty()) continue;
    const auto count = std::min(neighbors[i].size(), static_cast<std::size_t>(kNormalNeighbors));
    const auto neighbor = [&](std::size_t k) { return positions_in_cam[static_cast<std::size_t>(neighbors[i][k])]; };
    const auto distance = [&](std::size_t k) { return (neighbor(k) - positions_in_cam[i]).norm(); };
    const double reach = distance(count / 2);
    if (!(reach > 0.0)) continue;
    Eigen::Vector3d center = positions_in_cam[i];
    double sum = 1.0;
    std::vector<double> weights;
    for (std::size_t k = 0; k < count; ++k) {
      weights.push_back(std::exp(-0.5 * std::pow(distance(k) / reach, 2)));
      center += weights[k] * neighbor(k);
      sum += weights[k];
    }
    center /= sum;
    Eigen::Matrix3d spread = (positions_in_cam[i] - center) * (positions_in_cam[i] - center).transpose();
    for (std::size_t k = 0; k < count; ++k) {
      const Eigen::Vector3d arm = neighbor(k) - center;
      spread += weights[k] * arm * arm.transpose();
    }
    const Eigen::Vector3d normal = EigenOfSymmetric(spread).vectors.col(0);
    const double cosine = std::abs(normal.dot(positions_in_cam[i].normalized()));
    corrected[i] += kCosineExponent * std::log(std::max(kMinCosine, cosine));
  }
  return corrected;
}

LightFit CompareWithLight(const std::vector<Eigen::Vector3d>& positions_in_cam, const std::vector<double>& log_light) {
  if (positions_in_cam.empty()) return {};
  const std::vector<double> light =
      CorrectForInclination(positions_in_cam, NearestNeighbors(positions_in_cam, kNormalNeighbors), log_light);
  std::vector<double> distances;
  for (const Eigen::Vector3d& position : positions_in_cam) distances.push_back(position.norm());
  return FitWithin(kFar * Median(distances), distances, light);
}

LightFit CompareWithPrior(const std::vector<Eigen::Vector3d>& positions_in_cam, const std::vector<double>& log_prior) {
  std::vector<double> distances;
  for (const Eigen::Vector3d& position : positions_in_cam) distances.push_back(position.norm());
  return FitWithin(std::numeric_limits<double>::infinity(), distances, log_prior);
}

}  // namespace pliant
