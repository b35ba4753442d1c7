// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <filesystem>
#include <system_error>
#include <utility>

#include "pliant/base/files.h"
#include "pliant/evaluation/report.h"

namespace pliant {
namespace {

// Both or none.
Status WriteReports(const std::string& folder, const std::string& name, const std::string& json,
                    const std::string& csv) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return {ErrorCode::kUnwritable, "cannot make the folder " + folder + ": " + error.message()};
  FileGroup group;
  for (const auto& [ending, text] : {std::pair(".json", &json), std::pair(".csv", &csv)}) {
    auto file = group.Create((std::filesystem::path(folder) / (name + ending)).string());
    if (!file.ok()) return file.status();
    if (Status status = file->Append(*text); !status.ok()) return status;
    if (Status status = file->Close(); !status.ok()) return status;
  }
  return group.Commit();
}

}  // namespace

Status WriteEvaluation(const Evaluation& evaluation, const std::string& folder) {
  return WriteReports(folder, "evaluation", EvaluationJson(evaluation), EvaluationCsv(evaluation));
}

Status WriteComparison(std::span<const Evaluation> evaluations, const std::string& folder) {
  return WriteReports(folder, "comparison", ComparisonJson(evaluations), ComparisonCsv(evaluations));
}

}  // namespace pliant
