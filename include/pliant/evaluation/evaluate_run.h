// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// From a run folder and the path of its sequence to an evaluation.
#pragma once

#include <memory>
#include <string>

#include "pliant/base/status.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/datasets/sequence.h"
#include "pliant/evaluation/evaluation.h"

namespace pliant {

// A sequence opened for its truth. Opening a simulated one builds its scene again, so it serves several runs.
struct OpenedTruth {
  SequenceRequest request;
  std::unique_ptr<Sequence> sequence;
  Result<std::unique_ptr<MaterialTruth>> material = Status(ErrorCode::kNotFound, "it is not wanted");
};

// All of the sequence: without start, end and stride. Fails as OpenSequence does; without the truth of the material it
// is open all the same.
Result<OpenedTruth> OpenTruth(const SequenceRequest& request, const EvaluationOptions& options);

// Reads the run and evaluates. Fails as ReadEvaluationInput and Evaluate do.
Result<Evaluation> EvaluateRun(const std::string& run_path, const OpenedTruth& truth, const EvaluationOptions& options);

}  // namespace pliant
