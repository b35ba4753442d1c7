// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/map_remaker.h"

#include "tracking/window_map.h"

namespace pliant {
namespace {

// Of the demands on a deforming map. To wait for the next attempt costs more than a little uncertainty: meanwhile the
// map's errors grow.
constexpr double kRelaxed = 0.05;

}  // namespace

InitOutcome MapRemaker::Remake(const InitInput& input, WindowScene scene) const {
  InitOutcome outcome;
  outcome.decision = InitDecision::kNewReference;
  if (Status status = Make(input, scene, &outcome); !status.ok()) outcome.reason = status.message();
  return outcome;
}

Status MapRemaker::Make(const InitInput& input, WindowScene scene, InitOutcome* outcome) const {
  const bool may_deform = scene == WindowScene::kAny;
  if (may_deform)  // of a rotation the deforming window would make what it likes
    if (Status status = MoreThanARotation(input, &outcome->measured); !status.ok()) return status;
  const auto window = SolveWindow(input, input.frames.size(), scene, options_, nominal_depth_mm_);
  if (!window.ok()) return window.status();
  MapDemands demands = DemandsOf(options_, may_deform ? kRelaxed : 0.0);
  // Where the scene is rigid errors are of the tracks alone. What slides along a contour or over the surface, little at
  // a time, shows in them.
  demands.judges_tracks = window->solution.window.courses.rows() == 0;
  outcome->decision = InitDecision::kWait;
  return MakeWindowMap(input, *window, demands, options_, nominal_depth_mm_, outcome);
}

}  // namespace pliant
