// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <filesystem>
#include <fstream>
#include <system_error>

#include "pliant/evaluation/report.h"

namespace pliant {
namespace {

Status WriteReport(const std::string& folder, const std::string& file_name, const std::string& text) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return {ErrorCode::kUnwritable, "cannot make the folder " + folder + ": " + error.message()};
  const std::filesystem::path path = std::filesystem::path(folder) / file_name;
  std::ofstream file(path, std::ios::binary);
  file << text << std::flush;
  if (!file)
    return {ErrorCode::kUnwritable, "cannot write " + path.string() + "; is the disk full or the folder closed?"};
  return Status::Ok();
}

}  // namespace

Status WriteEvaluation(const Evaluation& evaluation, const std::string& folder) {
  if (Status status = WriteReport(folder, "evaluation.json", EvaluationJson(evaluation)); !status.ok()) return status;
  return WriteReport(folder, "evaluation.csv", EvaluationCsv(evaluation));
}

Status WriteComparison(std::span<const Evaluation> evaluations, const std::string& folder) {
  if (Status status = WriteReport(folder, "comparison.json", ComparisonJson(evaluations)); !status.ok()) return status;
  return WriteReport(folder, "comparison.csv", ComparisonCsv(evaluations));
}

}  // namespace pliant
