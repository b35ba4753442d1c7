// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/evaluate_run.h"

#include <utility>

namespace pliant {

Result<OpenedTruth> OpenTruth(const SequenceRequest& request, const EvaluationOptions& options) {
  OpenedTruth truth;
  truth.request = request;
  Result<std::unique_ptr<Sequence>> sequence = OpenSequence(request);
  if (!sequence.ok()) return sequence.status();
  truth.sequence = *std::move(sequence);
  if (options.Wants(EvaluationPart::kMaterial)) truth.material = OpenMaterialTruth(request.image_path.string());
  return truth;
}

Result<Evaluation> EvaluateRun(const std::string& run_path, const OpenedTruth& truth,
                               const EvaluationOptions& options) {
  const Result<EvaluationInput> input = ReadEvaluationInput(run_path, *truth.sequence, options.matching);
  if (!input.ok()) return input.status();
  const Result<MaterialTruth*> material =
      truth.material.ok() ? Result<MaterialTruth*>(truth.material->get()) : truth.material.status();
  const auto surface =
      OpenSurfaceTruth(options.surface_from, *input, *truth.sequence, truth.request, options.points.max_depth_step);
  if (!surface.ok()) return surface.status();
  Result<Evaluation> evaluation = Evaluate(*input, *truth.sequence, material, options, surface->get());
  if (evaluation.ok()) evaluation->sequence = truth.request.image_path.string();
  return evaluation;
}

}  // namespace pliant
