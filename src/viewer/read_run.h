// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A run folder as it is shown, in its own worlds and units.
#pragma once

#include <optional>
#include <string>

#include "pliant/base/status.h"
#include "pliant/datasets/sequence.h"
#include "pliant/viewer/view.h"

namespace pliant {

struct ReadViewedRun {
  ViewedRun run;
  std::optional<RunSummary> summary;  // nothing: another system's result
  std::vector<std::string> notes;     // what was left out
};

// With at most `max_observations` observations, of every n-th point. `sequence` may be null; another system's result
// needs it for its frames. Fails as ReadRun, ReadRunMap and ReadEvaluationInput do.
Result<ReadViewedRun> ReadRunForView(const std::string& run_path, const Sequence* sequence,
                                     std::int64_t max_observations);

// Depth and reprojection error of the frame's points. `camera` may be null.
void AddWhatPoseTells(const Camera* camera, ViewedFrame* frame);

ViewedObservation ToViewed(const PointObservation& observation);

}  // namespace pliant
