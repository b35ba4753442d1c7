// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The deforming window of the frames since the reference: its views, its points, its start and its solution.
#pragma once

#include <cstddef>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/estimation/deforming_window.h"
#include "pliant/tracking/initializer.h"
#include "pliant/tracking/window_initializer.h"

namespace pliant {

// The window of an input's first frames, ready to be solved.
struct PreparedWindow {
  std::vector<std::size_t> views;  // frames of the input, ascending
  std::vector<PointId> ids;        // of the window's points, sorted
  DeformingWindow start;
};

struct SolvedWindow {
  std::vector<std::size_t> views;
  std::vector<PointId> ids;
  DeformingSolution solution;
  bool light_is_of_no_use = false;  // it was to be used, and was not
};

// The window of the input's first `frames` frames. kInsufficient: what is missing.
Result<PreparedWindow> PrepareWindow(const InitInput& input, std::size_t frames, const WindowInitOptions& options,
                                     double nominal_depth_mm);

// Its solution with courses; where the light turns out to say nothing of it, the solution without light if that is more
// certain.
// kInsufficient, kDegenerate: what is missing.
Result<SolvedWindow> SolveDeforming(const InitInput& input, const PreparedWindow& window,
                                    const WindowInitOptions& options, double nominal_depth_mm);

// Its solution as a rigid scene; kDegenerate when the scene deforms, or in what else the solution fails.
Result<SolvedWindow> SolveRigid(const InitInput& input, const PreparedWindow& window, const WindowInitOptions& options);

// A point's place in the sorted `ids`, or -1.
int PlaceOf(PointId id, const std::vector<PointId>& ids);

// Those of `ids` that a frame sees, as observations of view `view_idx`; points are numbered by their place in `ids`.
std::vector<DeformingObservation> SeenIn(const InitInput& input, const InitFrame& frame,
                                         const std::vector<PointId>& ids, int view_idx,
                                         const WindowInitOptions& options);

}  // namespace pliant
