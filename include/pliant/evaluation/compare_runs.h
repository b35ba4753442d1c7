// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Several runs side by side: each evaluated against the truth of its sequence, or, without a sequence, against the
// first of them. One that cannot be evaluated does not keep the others from it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/base/job_progress.h"
#include "pliant/base/status.h"
#include "pliant/evaluation/evaluation.h"

namespace pliant {

struct CompareRequest {
  std::vector<std::string> run_paths;
  std::vector<std::string> sequence_paths = {};  // one for all runs, or one for each; none: they have no truth
  std::string camera_path = {};  // calibration of the sequences; empty: their own, or that of a run of the same images
};

struct RunComparison {
  std::vector<std::optional<Evaluation>> evaluations;  // one a run, in their order; nothing: it cannot be evaluated
  std::vector<Status> failures;                        // why, each once

  // Those that there are, in their order.
  std::vector<Evaluation> Evaluated() const;
};

// Fails with kInvalidArgument where there is no run, or one alone without a sequence, and where there are sequences,
// but not one for all runs or one for each.
Status CheckCompareRequest(const CompareRequest& request);

// Fails as CheckCompareRequest, and with kInterrupted. A sequence that several runs in a row share is opened once.
Result<RunComparison> CompareRuns(const CompareRequest& request, const EvaluationOptions& options,
                                  const JobProgress& progress = {});

// Writes comparison.json and comparison.csv into `folder`, and evaluation.json and evaluation.csv of each run into its
// folders 0, 1, ... in their order. Fails with kUnwritable.
Status WriteRunComparison(const RunComparison& comparison, const std::string& folder);

}  // namespace pliant
