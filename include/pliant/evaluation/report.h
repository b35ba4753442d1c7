// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Evaluations in print: a table for a person, JSON and CSV for programs. The names of the figures are documented in
// docs/formats.md and do not change.
#pragma once

#include <span>
#include <string>

#include "pliant/base/status.h"
#include "pliant/evaluation/evaluation.h"

namespace pliant {

// About thirty lines for a person; figures beside their null.
std::string EvaluationTable(const Evaluation& evaluation);
// Every figure by name; per-frame values in `frames`.
std::string EvaluationJson(const Evaluation& evaluation);
// One row a frame read, header first; a figure that a frame does not have is empty.
std::string EvaluationCsv(const Evaluation& evaluation);

// The same for several runs side by side, a row a run, in their order: the main figures as a table and as CSV, and all
// that EvaluationJson has but the frames as JSON, in `runs`.
std::string ComparisonTable(std::span<const Evaluation> evaluations);
std::string ComparisonJson(std::span<const Evaluation> evaluations);
std::string ComparisonCsv(std::span<const Evaluation> evaluations);

// Writes evaluation.json and evaluation.csv, comparison.json and comparison.csv, into `folder`, which is made where it
// is not there. Fails with kUnwritable.
Status WriteEvaluation(const Evaluation& evaluation, const std::string& folder);
Status WriteComparison(std::span<const Evaluation> evaluations, const std::string& folder);

}  // namespace pliant
