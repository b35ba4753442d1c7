// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The table of a run's figures.
#pragma once

#include <optional>
#include <vector>

#include "pliant/evaluation/evaluation.h"
#include "pliant/io/run_summary.h"
#include "pliant/viewer/view.h"

namespace pliant {

// What the run says of itself, and the evaluation where there is one.
std::vector<NamedText> RunFigures(const ViewedRun& run, const std::optional<RunSummary>& summary,
                                  const std::optional<Evaluation>& evaluation);

}  // namespace pliant
