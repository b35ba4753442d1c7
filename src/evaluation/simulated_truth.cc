// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <utility>

#include "pliant/evaluation/material_truth.h"
#include "pliant/simulation/open_simulation.h"

namespace pliant {
namespace {

class SimulatedTruth final : public MaterialTruth {
 public:
  explicit SimulatedTruth(Simulator simulator) : simulator_(std::move(simulator)) {}

  Result<std::vector<std::optional<MaterialId>>> PointsAt(int frame_idx,
                                                          std::span<const Eigen::Vector2d> pixels) override {
    std::vector<std::optional<MaterialId>> ids;
    for (const std::optional<SurfaceHit>& hit : simulator_.HitsAt(frame_idx, pixels)) {
      ids.emplace_back();
      if (!hit) continue;
      ids.back() = MaterialId{static_cast<std::int64_t>(points_.size())};
      points_.push_back(hit->point);
    }
    return ids;
  }

  Result<std::vector<std::optional<MaterialState>>> Observe(int frame_idx,
                                                            std::span<const MaterialId> points) override {
    std::vector<MaterialPoint> material;
    for (const MaterialId id : points) material.push_back(points_[static_cast<std::size_t>(id.value)]);
    const Rigid3 cam_from_world = simulator_.WorldFromCamera(frame_idx).Inverse();
    std::vector<std::optional<MaterialState>> states;
    for (const MaterialObservation& seen : simulator_.Observe(frame_idx, material)) {
      MaterialState state{cam_from_world * seen.point_in_world, std::nullopt, MaterialVisibility::kVisible};
      state.pixel = simulator_.camera().Project(state.point_in_cam);
      if (seen.visibility == Visibility::kOccluded) state.visibility = MaterialVisibility::kOccluded;
      if (seen.visibility == Visibility::kOutsideImage) state.visibility = MaterialVisibility::kOutsideImage;
      states.emplace_back(state);
    }
    return states;
  }

 private:
  Simulator simulator_;
  std::vector<MaterialPoint> points_;
};

}  // namespace

Result<std::unique_ptr<MaterialTruth>> OpenMaterialTruth(const std::string& sequence_path) {
  Result<Simulator> simulator = OpenSimulation(sequence_path);
  if (!simulator.ok()) return simulator.status();
  return std::unique_ptr<MaterialTruth>(std::make_unique<SimulatedTruth>(*std::move(simulator)));
}

}  // namespace pliant
