// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How the worlds of two runs lie to each other, by the frames that both have.
#pragma once

#include <map>
#include <span>
#include <utility>
#include <vector>

#include "pliant/base/ids.h"
#include "pliant/base/status.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/geometry/sim3.h"
#include "pliant/pipeline/join_runs.h"
#include "pliant/scene/frame_report.h"

namespace pliant {

// A frame as one run has it.
struct JointView {
  Rigid3 cam_from_world;
  std::vector<PointObservation> observations;  // sorted by id
};

// A frame that two runs have.
struct SharedFrame {
  JointView before;
  JointView after;
};

enum class JointScale { kEstimated, kOne };

struct WorldJoint {
  Sim3 before_from_after;
  int points = 0;
  double depth_difference = 0;
  double depth_spread = 0;
  std::map<PointId, PointId> same_points;  // before's, by after's
};

// (J1, J2) Of one submap of each run. Fails with kInsufficient where too few depths can be compared.
Result<WorldJoint> JoinWorlds(std::span<const SharedFrame> frames, int width_px, JointScale scale,
                              const JoinOptions& options);

}  // namespace pliant
