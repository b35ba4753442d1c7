// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Which frames of a run a frame's dense depth is to be found with.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pliant/geometry/rigid3.h"
#include "pliant/pipeline/surface_run.h"
#include "pliant/scene/frame_report.h"

namespace pliant {

// A frame of one submap of a run.
struct PosedFrame {
  int frame_idx = 0;
  int submap = 0;
  Rigid3 cam_from_world;
  std::vector<PointObservation> observations;  // sorted by id
};

// (V9) Positions in `frames`, which are in the order of time: as many before as after, at even distances out to the
// last one with enough points in common and no more than the largest parallax. Fewer at the ends of a submap.
std::vector<std::size_t> ChooseNeighbors(std::span<const PosedFrame> frames, std::size_t reference,
                                         const SurfaceRunOptions& options);

}  // namespace pliant
