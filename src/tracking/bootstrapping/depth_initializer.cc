// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <optional>
#include <string>
#include <vector>

#include "pliant/image/depth_lookup.h"
#include "pliant/tracking/bootstrapping/make_initializer.h"
#include "tracking/bootstrapping/initial_map.h"

namespace pliant {
namespace {

class DepthInitializer final : public Initializer {
 public:
  explicit DepthInitializer(const DepthInitOptions& options) : options_(options) {}

  std::string_view name() const override { return "depth"; }

  InitOutcome Try(const InitInput& input) const override {
    InitOutcome outcome;
    if (input.reference_depth_mm.empty()) {
      outcome.decision = InitDecision::kNewReference;
      outcome.reason = options_.cloud_path.empty()
                           ? "the frame has no depth image, which a start from depth needs; choose another Init.method"
                           : "a point cloud is of the first frame alone, and a start from it is not possible later";
      return outcome;
    }
    std::vector<std::optional<double>> depths_mm;
    for (const InitObservation& observation : input.frames.front().observations) {
      const DepthAtPixel depth = LookUpDepth(input.reference_depth_mm, observation.pixel, options_.max_depth_step);
      depths_mm.push_back(depth.lookup == DepthLookup::kOk ? std::optional(depth.depth_mm) : std::nullopt);
    }
    BackProjectDepths(input, depths_mm, &outcome);
    const std::string count = std::to_string(outcome.points.size());
    if (outcome.measured.inliers < options_.min_points) {
      outcome.decision = InitDecision::kNewReference;
      outcome.reason = "only " + count + " corners have a usable depth, of at least " +
                       std::to_string(options_.min_points) + " that a map needs";
      return outcome;
    }
    FillKnownMap(input, options_.cloud_path.empty() ? "the depth image" : "the point cloud", &outcome);
    return outcome;
  }

 private:
  DepthInitOptions options_;
};

}  // namespace

void DepthInitOptions::List(OptionTable& table) {
  table.Add("depth_max_step", &max_depth_step, "-",
            "depth: maximum relative difference of depth among the four pixels around a corner", 1e-6, 1);
  table.Add("depth_cloud", &cloud_path, "FILE",
            "depth: a point cloud (.npy, .ply, text) in the frame of the first camera, x right, y down, z "
            "forward, instead of depth images; relative to the working folder");
  table.Add("depth_cloud_unit_mm", &cloud_unit_mm, "mm", "depth: length of the point cloud's unit; 1000 for meters",
            1e-9, 1e9);
  table.Add("depth_min_points", &min_points, "-", "depth: minimum number of corners with depth", 4, 100000);
}

std::unique_ptr<Initializer> MakeDepthInitializer(const DepthInitOptions& options) {
  return std::make_unique<DepthInitializer>(options);
}

}  // namespace pliant
