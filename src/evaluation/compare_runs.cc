// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/compare_runs.h"

#include <filesystem>
#include <map>
#include <utility>

#include "pliant/datasets/run_sequence.h"
#include "pliant/evaluation/evaluate_run.h"
#include "pliant/evaluation/report.h"

namespace pliant {
namespace {

// A run that does not say its calibration takes that of another one of the same images.
std::vector<SequenceRequest> SequencesOf(const CompareRequest& request) {
  std::vector<SequenceRequest> sequences;
  std::map<std::filesystem::path, std::filesystem::path> spare_of;
  for (std::size_t i = 0; i < request.run_paths.size(); ++i) {
    const std::string& path = request.sequence_paths[request.sequence_paths.size() == 1 ? 0 : i];
    sequences.push_back(SequenceOfRun(request.run_paths[i], path, request.camera_path).Whole());
    if (!sequences.back().spare_camera_path.empty()) spare_of.emplace(path, sequences.back().spare_camera_path);
  }
  for (SequenceRequest& sequence : sequences)
    if (const auto spare = spare_of.find(sequence.image_path);
        spare != spare_of.end() && sequence.spare_camera_path.empty())
      sequence.spare_camera_path = spare->second;
  return sequences;
}

// Each but the first against the first.
Result<Evaluation> WithoutTruth(const CompareRequest& request, std::size_t i, const EvaluationOptions& options,
                                const JobProgress& progress) {
  const std::string& path = request.run_paths[i];
  if (i == 0) return EvaluateRun(path, RunReferences{}, options, progress);
  const std::vector<std::string> others = {request.run_paths.front()};
  return EvaluateRun(path, RunReferences{.other_runs = others}, options, progress);
}

bool IsSame(const SequenceRequest& a, const SequenceRequest& b) {
  return a.image_path == b.image_path && a.spare_camera_path == b.spare_camera_path && a.mask_path == b.mask_path;
}

}  // namespace

std::vector<Evaluation> RunComparison::Evaluated() const {
  std::vector<Evaluation> evaluated;
  for (const std::optional<Evaluation>& evaluation : evaluations)
    if (evaluation) evaluated.push_back(*evaluation);
  return evaluated;
}

Status CheckCompareRequest(const CompareRequest& request) {
  const std::size_t runs = request.run_paths.size();
  const std::size_t sequences = request.sequence_paths.size();
  if (runs == 0) return {ErrorCode::kInvalidArgument, "there is no run to compare; give the folders of two or more"};
  if (sequences == 0 && runs == 1)
    return {ErrorCode::kInvalidArgument,
            "there is one run and no sequence to compare it with; give another run, or the sequence with its truth"};
  if (sequences == 0 || sequences == 1 || sequences == runs) return Status::Ok();
  return {ErrorCode::kInvalidArgument, "the number of sequences is " + std::to_string(sequences) + " for " +
                                           std::to_string(runs) + " runs; give one for all of them, or one for each"};
}

Result<RunComparison> CompareRuns(const CompareRequest& request, const EvaluationOptions& options,
                                  const JobProgress& progress) {
  if (Status status = CheckCompareRequest(request); !status.ok()) return status;
  RunComparison comparison;
  comparison.evaluations.resize(request.run_paths.size());
  const bool has_truth = !request.sequence_paths.empty();
  const std::vector<SequenceRequest> sequences = has_truth ? SequencesOf(request) : std::vector<SequenceRequest>();
  std::optional<Result<OpenedTruth>> truth;
  for (std::size_t i = 0; i < request.run_paths.size(); ++i) {
    if (has_truth && (!truth || !IsSame(sequences[i], sequences[i - 1]))) {
      truth = OpenTruth(sequences[i], options);
      if (!truth->ok()) comparison.failures.push_back(truth->status());
    }
    if (has_truth && !truth->ok()) continue;
    Result<Evaluation> evaluation = has_truth ? EvaluateRun(request.run_paths[i], **truth, options, progress)
                                              : WithoutTruth(request, i, options, progress);
    if (evaluation.ok())
      comparison.evaluations[i] = *std::move(evaluation);
    else if (evaluation.status().code() == ErrorCode::kInterrupted)
      return evaluation.status();
    else
      comparison.failures.push_back(evaluation.status());
  }
  return comparison;
}

Status WriteRunComparison(const RunComparison& comparison, const std::string& folder) {
  for (std::size_t i = 0; i < comparison.evaluations.size(); ++i)
    if (comparison.evaluations[i])
      if (Status status = WriteEvaluation(*comparison.evaluations[i], folder + "/" + std::to_string(i)); !status.ok())
        return status;
  return WriteComparison(comparison.Evaluated(), folder);
}

}  // namespace pliant
