// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <vector>

#include "pliant/tracking/bootstrapping/make_initializer.h"
#include "tracking/bootstrapping/initial_map.h"

namespace pliant {
namespace {

class KnownPointsInitializer final : public Initializer {
 public:
  KnownPointsInitializer(const KnownPoints& known, double nominal_depth_mm)
      : known_(known), nominal_depth_mm_(nominal_depth_mm) {}

  std::string_view name() const override { return known_.name; }
  bool TakesKnownPoints() const override { return true; }

  InitOutcome Try(const InitInput& input) const override {
    InitOutcome outcome;
    std::vector<std::optional<double>> depths(input.reference_depths.begin(), input.reference_depths.end());
    depths.resize(input.frames.front().observations.size());
    BackProjectDepths(input, depths, &outcome);
    std::vector<Eigen::Vector3d> positions;
    for (const InitPoint& point : outcome.points) positions.push_back(point.position);
    const std::string count = std::to_string(positions.size());
    const auto scale = known_.unit_mm > 0 ? Result<double>(known_.unit_mm) : NominalScale(positions, nominal_depth_mm_);
    if (outcome.measured.inliers < known_.min_points || !scale.ok()) {
      outcome.decision = InitDecision::kNewReference;
      outcome.reason = std::string(known_.source) + " has only " + count +
                       " usable points in this image, of at least " + std::to_string(known_.min_points) +
                       " that a map needs";
      return outcome;
    }
    for (InitPoint& point : outcome.points) point.position *= *scale;
    FillKnownMap(input, known_.source, &outcome);
    return outcome;
  }

 private:
  KnownPoints known_;
  double nominal_depth_mm_;
};

}  // namespace

void ModelInitOptions::List(OptionTable& table) {
  table.Add("model_path", &path, "DIR", "colmap_model: folder of the COLMAP model; relative to the working folder");
  table.Add("model_unit_mm", &unit_mm, "mm",
            "colmap_model: length of the model's unit; 0: unknown, the median depth becomes nominal_depth_mm", 0, 1e9);
  table.Add("model_min_points", &min_points, "-", "colmap_model: minimum number of the model's points in an image", 4,
            100000);
}

std::unique_ptr<Initializer> MakeKnownPointsInitializer(const KnownPoints& known, double nominal_depth_mm) {
  return std::make_unique<KnownPointsInitializer>(known, nominal_depth_mm);
}

}  // namespace pliant
