// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "pliant/base/statistics.h"
#include "pliant/tracking/bootstrapping/make_initializer.h"
#include "tracking/bootstrapping/initial_map.h"
#include "tracking/depth_prior/scale_and_shift.h"

namespace pliant {
namespace {

// A light from which the prior with a shift differs by more than this, by the spread of log depths and by how much it
// differs without a shift, says nothing of the shift.
constexpr double kMaxDifferenceOfSpread = 0.8;

// One image: nothing but the prior says how deep it is, up to a scale, and nobody how well.
class PriorInitializer final : public Initializer {
 public:
  PriorInitializer(const MonocularInitOptions& options, const WindowInitOptions& window, DepthPriorKind kind)
      : options_(options), window_(window), kind_(kind) {}

  std::string_view name() const override { return "depth_prior"; }

  InitOutcome Try(const InitInput& input) const override {
    InitOutcome outcome;
    const auto shift = ShiftByLight(input);
    InitialMap map;
    std::vector<InitRejectedPoint> rejected;
    for (const InitObservation& seen : input.frames.front().observations) {
      const auto ray = input.camera.Unproject(seen.pixel);
      const double depth = ray ? Depth(Value(seen, *ray), shift) : 0.0;
      if (!(depth > 0.0)) {
        rejected.push_back({seen.id, ray ? InitRejection::kUncertainDepth : InitRejection::kNoRay});
        continue;
      }
      map.ids.push_back(seen.id);
      map.positions.push_back(*ray * (depth / ray->z()));
    }
    map.depth_sigmas.assign(map.ids.size(), 0.0);
    map.parallaxes_rad.assign(map.ids.size(), 0.0);
    outcome.measured.correspondences = static_cast<int>(input.frames.front().observations.size());
    outcome.measured.inliers = static_cast<int>(map.ids.size());
    if (Status status = MakeMap(input, map, std::move(rejected), &outcome); !status.ok()) {
      outcome.decision = InitDecision::kNewReference;
      outcome.reason = status.message();
      return outcome;
    }
    outcome.provisional = true;
    outcome.uses_prior = true;
    outcome.reason = "provisional map of " + std::to_string(map.ids.size()) +
                     " points from the depth prior of one image, with " +
                     (shift ? "the shift that brightness says" : "no shift") + ": nothing has confirmed it";
    return outcome;
  }

 private:
  Status MakeMap(const InitInput& input, const InitialMap& map, std::vector<InitRejectedPoint> rejected,
                 InitOutcome* outcome) const {
    if (map.ids.empty())
      return {ErrorCode::kInsufficient,
              "the image has no depth prior at its corners; give one with it, or choose another Init.method"};
    if (outcome->measured.inliers < options_.min_points)
      return {ErrorCode::kInsufficient, "the depth prior says something of only " + std::to_string(map.ids.size()) +
                                            " corners of this image, of at least " +
                                            std::to_string(options_.min_points) + " that a map needs"};
    return FillRigidMap(input, map, {Rigid3()}, std::move(rejected), options_.nominal_depth_mm, outcome);
  }

  // What the prior's own value is proportional to: z or 1 / z (N1).
  double Value(const InitObservation& seen, const Eigen::Vector3d& ray) const {
    const double depth = std::exp(seen.log_prior) * ray.z() / ray.norm();
    return kind_ == DepthPriorKind::kDepth ? depth : 1.0 / depth;
  }

  // Not above 0: there is none.
  double Depth(double value, const std::optional<ScaleAndShift>& fit) const {
    const double shifted = fit ? fit->scale * value + fit->shift : value;
    return kind_ == DepthPriorKind::kDepth || !(shifted > 0.0) ? shifted : 1.0 / shifted;
  }

  // (N3). Nothing where brightness says next to nothing of these distances, or of a shift.
  std::optional<ScaleAndShift> ShiftByLight(const InitInput& input) const {
    if (window_.light == Switch::kOff) return std::nullopt;
    const PhotometricCalibration light = input.photometric.value_or(PhotometricCalibration{.gamma = window_.gamma});
    std::vector<double> values;
    std::vector<double> targets;
    std::vector<double> log_targets;
    std::vector<double> log_ratios;
    for (const InitObservation& seen : input.frames.front().observations) {
      const auto ray = input.camera.Unproject(seen.pixel);
      if (!ray || !(ray->z() > 0.0) || !std::isfinite(seen.log_prior)) continue;
      const double log_distance = LogDistanceFromLight(light, seen.brightness, *ray);
      if (!std::isfinite(log_distance)) continue;
      const double log_depth = log_distance + std::log(ray->z() / ray->norm());
      log_targets.push_back(kind_ == DepthPriorKind::kDepth ? log_depth : -log_depth);
      values.push_back(Value(seen, *ray));
      targets.push_back(std::exp(log_targets.back()));
      log_ratios.push_back(log_targets.back() - std::log(values.back()));
    }
    const auto fit = FitScaleAndShift(values, targets);
    if (!fit || values.empty()) return std::nullopt;
    const double spread = kMedianToSigma * MedianDeviation(std::move(log_targets));
    const double without = kMedianToSigma * MedianDeviation(std::move(log_ratios));
    return fit->sigma <= kMaxDifferenceOfSpread * std::min(spread, without) ? fit : std::nullopt;
  }

  MonocularInitOptions options_;
  WindowInitOptions window_;
  DepthPriorKind kind_;
};

}  // namespace

std::unique_ptr<Initializer> MakePriorInitializer(const MonocularInitOptions& options, const WindowInitOptions& window,
                                                  DepthPriorKind kind) {
  return std::make_unique<PriorInitializer>(options, window, kind);
}

}  // namespace pliant
