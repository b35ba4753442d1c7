// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/depth_prior/prior_agreement.h"

#include <cmath>
#include <vector>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

constexpr std::size_t kMinCompared = 12;
// Rank correlations above are clear: that with the map of a prior with a network's errors is 0.7 or more. Brightness
// has to be clearer, since other lights and the colors of a scene correlate with depth by chance, by up to 0.7 over
// many frames of a room.
constexpr double kClearByMap = 0.5;
constexpr double kClearByBrightness = 0.7;

// `log_distance`: of a landmark on its ray; NaN: not known.
template <class LogDistance>
std::optional<PriorAgreement> Agreement(const PriorDistances& prior, const Camera& camera,
                                        std::span<const Landmark> landmarks, double clear,
                                        const LogDistance& log_distance) {
  std::vector<double> by_prior;
  std::vector<double> by_other;
  for (const Landmark& landmark : landmarks) {
    const double log_prior = prior.LogAt(landmark.pixel);
    if (!std::isfinite(log_prior)) continue;
    const Eigen::Vector3d ray = *camera.Unproject(landmark.pixel);  // there is one where the prior has a distance
    const double log_other = log_distance(landmark, ray);
    if (!std::isfinite(log_other)) continue;
    const double log_cosine = std::log(ray.z() / ray.norm());  // distances of a plane agree by it, whatever the kind
    by_prior.push_back(log_prior + log_cosine);
    by_other.push_back(log_other + log_cosine);
  }
  if (by_prior.size() < kMinCompared) return std::nullopt;
  const double correlation = RankCorrelation(by_prior, by_other);
  if (std::abs(correlation) < clear) return PriorAgreement::kUnclear;
  return correlation > 0.0 ? PriorAgreement::kAgrees : PriorAgreement::kFalls;
}

}  // namespace

std::optional<PriorAgreement> AgreementWithMap(const PriorDistances& prior, const Camera& camera,
                                               std::span<const Landmark> landmarks, const Rigid3& cam_from_world) {
  return Agreement(prior, camera, landmarks, kClearByMap, [&](const Landmark& landmark, const Eigen::Vector3d&) {
    return std::log((cam_from_world * landmark.position).norm());
  });
}

std::optional<PriorAgreement> AgreementWithBrightness(const PriorDistances& prior, const Camera& camera,
                                                      std::span<const Landmark> landmarks,
                                                      const LocalBrightness& brightness,
                                                      const PhotometricCalibration& light) {
  return Agreement(prior, camera, landmarks, kClearByBrightness,
                   [&](const Landmark& landmark, const Eigen::Vector3d& ray) {
                     return LogDistanceFromLight(light, brightness.At(landmark.pixel), ray);
                   });
}

}  // namespace pliant
