// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/bootstrapping/oracle_initializer.h"

#include <string>
#include <utility>
#include <vector>

#include "pliant/base/statistics.h"
#include "tracking/bootstrapping/initial_map.h"

namespace pliant {
namespace {

class OracleInitializer final : public Initializer {
 public:
  OracleInitializer(TrackingTruth* truth, std::optional<double> nominal_depth_mm, int min_points,
                    std::unique_ptr<Initializer> replaced)
      : truth_(truth), nominal_depth_mm_(nominal_depth_mm), min_points_(min_points), replaced_(std::move(replaced)) {}

  std::string_view name() const override { return "oracle"; }
  bool TakesKnownPoints() const override { return replaced_->TakesKnownPoints(); }
  InitOutcome Try(const InitInput& input) const override;

 private:
  TrackingTruth* truth_;
  std::optional<double> nominal_depth_mm_;
  int min_points_;
  std::unique_ptr<Initializer> replaced_;
};

InitOutcome OracleInitializer::Try(const InitInput& input) const {
  const InitFrame& reference = input.frames.front();
  const auto depths = truth_->DepthsAt(reference.frame_idx, PixelsOf(reference.observations));
  InitOutcome outcome;
  InitialMap map;
  std::vector<InitRejectedPoint> rejected;
  std::vector<double> z_mm;
  for (std::size_t k = 0; k < depths.size(); ++k) {
    const PointId id = reference.observations[k].id;
    const auto ray = input.camera.Unproject(reference.observations[k].pixel);
    if (!ray || ray->z() <= 0 || !depths[k]) {
      rejected.push_back({id, InitRejection::kNoRay});
      continue;
    }
    map.ids.push_back(id);
    map.positions.push_back(*ray * (*depths[k] / ray->z()));
    z_mm.push_back(*depths[k]);
  }
  map.depth_sigmas.assign(map.ids.size(), 0.0);
  map.parallaxes_rad.assign(map.ids.size(), 0.0);
  outcome.measured.correspondences = static_cast<int>(depths.size());
  outcome.measured.inliers = static_cast<int>(map.ids.size());
  const std::string count = std::to_string(map.ids.size());
  outcome.decision = InitDecision::kNewReference;
  if (outcome.measured.inliers < min_points_) {
    outcome.reason = "only " + count + " corners lie on the surface, of at least " + std::to_string(min_points_);
    return outcome;
  }
  const double median_mm = nominal_depth_mm_ ? *nominal_depth_mm_ : Median(std::move(z_mm));
  const Status filled = FillRigidMap(input, map, {Rigid3()}, std::move(rejected), median_mm, &outcome);
  outcome.reason = filled.ok() ? "first map of " + count + " points at their true depths" : filled.message();
  return outcome;
}

}  // namespace

std::unique_ptr<Initializer> MakeOracleInitializer(TrackingTruth* truth, std::optional<double> nominal_depth_mm,
                                                   int min_points, std::unique_ptr<Initializer> replaced) {
  return std::make_unique<OracleInitializer>(truth, nominal_depth_mm, min_points, std::move(replaced));
}

}  // namespace pliant
