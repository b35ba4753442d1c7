// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/run_evaluation.h"

#include <filesystem>
#include <fstream>
#include <memory>
#include <system_error>

#include "pliant/datasets/open_sequence.h"

namespace pliant::cli {
namespace {

Status WriteText(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text << std::flush;
  if (!file)
    return {ErrorCode::kUnwritable, "cannot write " + path.string() + "; is the disk full or the folder closed?"};
  return Status::Ok();
}

}  // namespace

Result<Evaluation> EvaluateRun(const std::string& run_path, const std::string& sequence_path,
                               const EvaluationOptions& options) {
  const Result<EvaluationInput> input = ReadEvaluationInput(run_path);
  if (!input.ok()) return input.status();
  SequenceRequest request;
  request.image_path = sequence_path;
  const Result<std::unique_ptr<Sequence>> sequence = OpenSequence(request);
  if (!sequence.ok()) return sequence.status();
  return Evaluate(*input, **sequence, options);
}

Status WriteEvaluation(const Evaluation& evaluation, const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return {ErrorCode::kUnwritable, "cannot make the folder " + folder + ": " + error.message()};
  if (Status status = WriteText(std::filesystem::path(folder) / "evaluation.json", EvaluationJson(evaluation));
      !status.ok())
    return status;
  return WriteText(std::filesystem::path(folder) / "evaluation.csv", EvaluationCsv(evaluation));
}

}  // namespace pliant::cli
