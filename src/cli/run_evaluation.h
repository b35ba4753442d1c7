// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A run folder against the truth of its sequence, for the commands that do that.
#pragma once

#include <string>

#include "pliant/base/status.h"
#include "pliant/evaluation/evaluation.h"

namespace pliant::cli {

// Reads both and evaluates. Fails as ReadRun, OpenSequence and Evaluate do.
Result<Evaluation> EvaluateRun(const std::string& run_path, const std::string& sequence_path,
                               const EvaluationOptions& options);

// Writes evaluation.json and evaluation.csv into `folder`, which is made where it is not there. Fails with kUnwritable.
Status WriteEvaluation(const Evaluation& evaluation, const std::string& folder);

}  // namespace pliant::cli
