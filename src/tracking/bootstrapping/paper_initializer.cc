// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Initialization as published (Gomez Rodriguez, Montiel, Tardos, IROS 2022, section III-B): k frames apart, no gates.
#include <numbers>

#include "pliant/base/statistics.h"
#include "pliant/base/text.h"
#include "pliant/tracking/bootstrapping/make_initializer.h"
#include "tracking/bootstrapping/initial_map.h"

namespace pliant {
namespace {

class PaperInitializer final : public Initializer {
 public:
  PaperInitializer(const MonocularInitOptions& options, Random random) : options_(options), random_(random) {}

  std::string_view name() const override { return "paper"; }

  InitOutcome Try(const InitInput& input) const override {
    InitOutcome outcome;
    const int since = static_cast<int>(input.frames.size()) - 1;
    if (since < options_.paper_frames) {
      outcome.reason =
          std::to_string(since) + " of " + std::to_string(options_.paper_frames) + " frames since the reference";
      return outcome;
    }
    if (Status status = MakeMap(input, &outcome); !status.ok()) {
      outcome.decision = InitDecision::kNewReference;
      outcome.reason = status.message();
    }
    return outcome;
  }

 private:
  Status MakeMap(const InitInput& input, InitOutcome* outcome) const {
    MatchedRays matched = MatchRays(input.camera, input.frames.front(), input.frames.back());
    outcome->measured.correspondences = static_cast<int>(matched.ids.size());
    const double focal_px = input.camera.MeanFocalLengthPx();
    const auto pose = EstimateMotion(matched, focal_px, options_, random_);
    if (!pose.ok()) return pose.status();
    outcome->measured.inliers = pose->num_inliers;

    const InitialMap map = TriangulateInliers(pose->cam1_from_cam0, pose->inliers, focal_px, options_, &matched);
    if (map.ids.empty()) return {ErrorCode::kInsufficient, "no point could be triangulated"};
    outcome->measured.median_parallax_deg = Median(map.parallaxes_rad) * 180.0 / std::numbers::pi;

    std::vector<KnownPose> known(input.frames.size());
    known.front().known = true;
    known.back() = {true, pose->cam1_from_cam0};
    const auto poses = EstimateFramePoses(input, map, std::move(known), {});
    if (!poses.ok()) return poses.status();
    outcome->reason = "first map of " + std::to_string(map.ids.size()) + " points, " +
                      std::to_string(input.frames.size() - 1) + " frames apart, median parallax " +
                      Digits(outcome->measured.median_parallax_deg, 2) + " deg";
    return FillRigidMap(input, map, *poses, std::move(matched.rejected), options_.nominal_depth_mm, outcome);
  }

  MonocularInitOptions options_;
  Random random_;
};

}  // namespace

std::unique_ptr<Initializer> MakePaperInitializer(const MonocularInitOptions& options, Random random) {
  return std::make_unique<PaperInitializer>(options, random);
}

}  // namespace pliant
