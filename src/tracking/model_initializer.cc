// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/model_initializer.h"

#include <vector>

#include "tracking/initial_map.h"

namespace pliant {
namespace {

class ModelInitializer final : public Initializer {
 public:
  ModelInitializer(const ModelInitOptions& options, double nominal_depth_mm)
      : options_(options), nominal_depth_mm_(nominal_depth_mm) {}

  std::string_view name() const override { return "colmap_model"; }

  InitOutcome Try(const InitInput& input) const override {
    InitOutcome outcome;
    const std::vector<InitObservation>& observations = input.frames.front().observations;
    outcome.measured.correspondences = static_cast<int>(observations.size());
    std::vector<Eigen::Vector3d> positions;
    for (std::size_t i = 0; i < observations.size() && i < input.reference_depths.size(); ++i) {
      const auto ray = input.camera.Unproject(observations[i].pixel);
      if (!ray || !(ray->z() > 0)) {
        outcome.rejected.push_back({observations[i].id, InitRejection::kNoRay});
        continue;
      }
      positions.emplace_back(*ray * (input.reference_depths[i] / ray->z()));
      outcome.points.push_back({observations[i].id, positions.back(), 0.0, 0.0});
    }
    outcome.measured.inliers = static_cast<int>(positions.size());
    const std::string count = std::to_string(positions.size());
    const auto scale =
        options_.unit_mm > 0 ? Result<double>(options_.unit_mm) : NominalScale(positions, nominal_depth_mm_);
    if (outcome.measured.inliers < options_.min_points || !scale.ok()) {
      outcome.decision = InitDecision::kNewReference;
      outcome.reason = "the model has only " + count + " usable points in this image, of at least " +
                       std::to_string(options_.min_points) + " that a map needs";
      return outcome;
    }
    for (InitPoint& point : outcome.points) point.position *= *scale;
    outcome.decision = InitDecision::kMap;
    outcome.reason = "first map of " + count + " points from the model";
    FillRigidFrames(input, {Rigid3()}, &outcome);  // the reference alone: this start never waits
    return outcome;
  }

 private:
  ModelInitOptions options_;
  double nominal_depth_mm_;
};

}  // namespace

void ModelInitOptions::List(OptionTable& table) {
  table.Add("model_path", &path, "DIR",
            "colmap_model: folder of the COLMAP model to start from; relative to the working folder");
  table.Add("model_unit_mm", &unit_mm, "mm",
            "colmap_model: what a unit of the model is; 0: not known, its median depth becomes nominal_depth_mm", 0,
            1e9);
  table.Add("model_min_points", &min_points, "-", "colmap_model: fewer points in an image make no map", 4, 100000);
}

std::unique_ptr<Initializer> MakeModelInitializer(const ModelInitOptions& options, double nominal_depth_mm) {
  return std::make_unique<ModelInitializer>(options, nominal_depth_mm);
}

}  // namespace pliant
