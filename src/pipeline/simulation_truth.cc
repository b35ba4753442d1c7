// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/simulation_truth.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "pliant/simulation/open_simulation.h"

namespace pliant {
namespace {

// camera.yaml carries its numbers in text.
constexpr double kSameParameter = 1e-6;

class SimulationTruth final : public TrackingTruth {
 public:
  explicit SimulationTruth(Simulator simulator) : simulator_(std::move(simulator)) {}

  Rigid3 WorldFromCamera(int frame_idx) const override { return simulator_.WorldFromCamera(frame_idx); }

  std::vector<std::optional<double>> DepthsAt(int frame_idx, std::span<const Eigen::Vector2d> pixels) override {
    std::vector<std::optional<double>> depths;
    for (const auto& hit : simulator_.HitsAt(frame_idx, pixels))
      depths.push_back(hit ? std::optional(hit->depth_mm) : std::nullopt);
    return depths;
  }

  std::vector<char> Follow(int frame_idx, std::span<const InitObservation> points) override {
    std::vector<Eigen::Vector2d> pixels;
    for (const InitObservation& point : points) pixels.push_back(point.pixel);
    const auto hits = simulator_.HitsAt(frame_idx, pixels);
    std::vector<char> on_surface;
    for (std::size_t k = 0; k < hits.size(); ++k) {
      on_surface.push_back(hits[k] ? 1 : 0);
      if (hits[k]) followed_.insert_or_assign(points[k].id, hits[k]->point);
    }
    return on_surface;
  }

  std::vector<TrueTrack> Locate(int frame_idx, std::span<const PointId> ids) override {
    std::vector<TrueTrack> tracks(ids.size());
    std::vector<MaterialPoint> points;
    std::vector<std::size_t> indices;
    for (std::size_t k = 0; k < ids.size(); ++k) {
      const auto found = followed_.find(ids[k]);
      if (found == followed_.end()) continue;
      points.push_back(found->second);
      indices.push_back(k);
    }
    const auto observations = simulator_.Observe(frame_idx, points);
    for (std::size_t n = 0; n < observations.size(); ++n) {
      TrueTrack& track = tracks[indices[n]];
      track.pixel = observations[n].pixel;
      if (observations[n].visibility == Visibility::kVisible) track.sight = TrueTrack::Sight::kVisible;
      if (observations[n].visibility == Visibility::kOccluded) track.sight = TrueTrack::Sight::kOccluded;
    }
    return tracks;
  }

 private:
  Simulator simulator_;
  std::map<PointId, MaterialPoint> followed_;
};

bool Same(const Camera& a, const Camera& b) {
  const auto close = [](double x, double y) { return std::abs(x - y) <= kSameParameter * std::max(1.0, std::abs(x)); };
  return a.model_id() == b.model_id() && a.width() == b.width() && a.height() == b.height() &&
         std::equal(a.params().begin(), a.params().end(), b.params().begin(), b.params().end(), close);
}

}  // namespace

Result<std::unique_ptr<TrackingTruth>> OpenSimulationTruth(const std::filesystem::path& folder,
                                                           const Sequence& sequence) {
  const std::filesystem::path file = folder / "simulation.yaml";
  std::error_code error;
  if (!std::filesystem::exists(file, error))
    return Status(ErrorCode::kNotFound,
                  "an oracle switch needs the truth of a sequence written by `pliant simulate`, "
                  "and '" +
                      folder.string() + "' has no simulation.yaml; switch it off");
  auto simulator = OpenSimulation(folder);
  if (!simulator.ok()) return simulator.status();
  if (!Same(simulator->camera(), sequence.camera()))
    return Status(ErrorCode::kMismatch, "the camera is not the one that '" + file.string() +
                                            "' describes, so its truth is not that of these images");
  if (sequence.size() > simulator->frame_count())
    return Status(ErrorCode::kMismatch, "'" + file.string() + "' describes " +
                                            std::to_string(simulator->frame_count()) +
                                            " frames, but the sequence has " + std::to_string(sequence.size()));
  return std::unique_ptr<TrackingTruth>(std::make_unique<SimulationTruth>(*std::move(simulator)));
}

}  // namespace pliant
