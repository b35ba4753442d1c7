// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/map_upkeep/reestimate_map.h"

#include "tracking/bootstrapping/rotation_check.h"
#include "tracking/bootstrapping/window_map.h"

namespace pliant {
namespace {

// By how much the demands on a deforming map are relaxed. To wait for the next attempt costs more than a little
// uncertainty: meanwhile the map's errors grow.
constexpr double kRelaxed = 0.05;

// What is missing for a map; ok when the outcome is one.
Status Reestimate(const InitInput& input, WindowScene scene, bool of_provisional, const WindowInitOptions& options,
                  double nominal_depth_mm, InitOutcome* outcome) {
  const bool may_deform = scene == WindowScene::kAny;
  if (may_deform)  // a rotation alone does not constrain the deforming window
    if (Status status = CheckWindowNotARotation(input, &outcome->measured); !status.ok()) return status;
  WindowInitOptions as_deforming = options;
  as_deforming.rigid_views = options.views;
  const auto window = SolveWindow(input, input.frames.size(), scene, as_deforming, nominal_depth_mm);
  if (!window.ok()) {
    outcome->deforming = window.status().code() == ErrorCode::kDegenerate;
    return window.status();
  }
  MapDemands demands = DemandsOf(options, may_deform ? kRelaxed : 0.0);
  // Where the scene is rigid errors are of the tracks alone. What drifts along a contour or over the surface, little at
  // a time, shows in them.
  demands.scales_sigmas_with_error = window->IsRigid();
  outcome->decision = InitDecision::kWait;
  Status status = MakeWindowMap(input, *window, demands, options, nominal_depth_mm, outcome);
  const bool is_settled = status.ok() || outcome->ambiguous || status.code() == ErrorCode::kDegenerate;
  if (is_settled || !of_provisional || !may_deform) return status;
  demands = ProvisionalDemands(window->solution.window, false);
  demands.scales_sigmas_with_error = window->IsRigid();
  return MakeWindowMap(input, *window, demands, options, nominal_depth_mm, outcome);
}

}  // namespace

InitOutcome ReestimateMap(const InitInput& input, WindowScene scene, bool of_provisional,
                          const WindowInitOptions& options, double nominal_depth_mm) {
  InitOutcome outcome;
  outcome.decision = InitDecision::kNewReference;
  if (Status status = Reestimate(input, scene, of_provisional, options, nominal_depth_mm, &outcome); !status.ok())
    outcome.reason = status.message();
  return outcome;
}

}  // namespace pliant
