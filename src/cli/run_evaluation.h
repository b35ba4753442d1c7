// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Run folders against the truth of their sequences, for the commands that do that.
#pragma once

#include <string>

#include "cli/command_line.h"
#include "pliant/base/status.h"
#include "pliant/evaluation/evaluate_run.h"

namespace pliant::cli {

// --protocol, --scale, --parts, --camera.
void AddEvaluationArguments(CommandLine* line, std::string* camera_path);

// Writes `text` into `folder`, which is made where it is not there. Fails with kUnwritable.
Status WriteReport(const std::string& folder, const std::string& file_name, const std::string& text);

// Writes evaluation.json and evaluation.csv into `folder`.
Status WriteEvaluation(const Evaluation& evaluation, const std::string& folder);

}  // namespace pliant::cli
