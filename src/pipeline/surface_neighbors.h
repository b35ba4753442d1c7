// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Which frames of a run a frame's dense depth is to be found with.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pipeline/run_views.h"
#include "pliant/pipeline/surface_run.h"

namespace pliant {

// (V9) Positions in `frames`, which are in the order of time: as many before as after, at even distances out to the
// last one with enough points in common and no more than the largest parallax. Fewer at the ends of a submap.
std::vector<std::size_t> ChooseNeighbors(std::span<const PosedFrame> frames, std::size_t reference,
                                         const SurfaceRunOptions& options);

}  // namespace pliant
