// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the truth of a sequence says of a run.
#pragma once

#include <optional>
#include <string>

#include "pliant/base/status.h"
#include "pliant/evaluation/evaluate_run.h"
#include "pliant/viewer/view.h"

namespace pliant {

// The run's frames without what was seen in them: for what asks of a run which frames it is of.
EvaluationInput FramesOf(const ViewedRun& run);

// Adds errors, scales and each point's true position to a run in its own worlds, and gives the figures. Fails as
// EvaluateRun does; a sequence without truth adds nothing.
Result<Evaluation> AddTruth(const std::string& run_path, const OpenedTruth& truth, const JobProgress& progress,
                            ViewedRun* run);

}  // namespace pliant
