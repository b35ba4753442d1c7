// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The table of a run's figures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/evaluation/evaluation.h"
#include "pliant/viewer/view.h"

namespace pliant {

// What the run folder itself says, and the evaluation where there is one. Fails as ReadRunSummary does for a file that
// is no run's.
Result<std::vector<NamedText>> RunFigures(const std::string& run_path, const ViewedRun& run,
                                          const std::optional<Evaluation>& evaluation);

}  // namespace pliant
