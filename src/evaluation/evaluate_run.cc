// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/evaluate_run.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include "pliant/base/text.h"
#include "pliant/datasets/run_sequence.h"
#include "pliant/evaluation/dense_completeness.h"

namespace pliant {
namespace {

Result<EvaluationInput> ReadInput(const std::string& run_path, const OpenedTruth* truth,
                                  const EvaluationOptions& options) {
  return truth != nullptr ? ReadEvaluationInput(run_path, *truth->sequence, options.matching)
                          : ReadEvaluationInput(run_path);
}

Result<Evaluation> EvaluateWithTruth(const EvaluationInput& run, const OpenedTruth& truth,
                                     const EvaluationOptions& options, const JobProgress& progress) {
  const Result<MaterialTruth*> material =
      truth.material.ok() ? Result<MaterialTruth*>(truth.material->get()) : truth.material.status();
  const auto surface =
      OpenSurfaceTruth(options.surface_from, run, *truth.sequence, truth.request, options.points.max_depth_step);
  if (!surface.ok()) return surface.status();
  Result<Evaluation> evaluation = Evaluate(run, *truth.sequence, material, options, surface->get(), progress);
  if (evaluation.ok()) evaluation->sequence = truth.request.image_path.string();
  return evaluation;
}

// Of the images; fails where nothing says it.
Result<int> WidthPx(const EvaluationInput& run, const OpenedTruth* truth) {
  if (run.camera) return run.camera->width();
  if (truth != nullptr) return truth->sequence->camera().width();
  return Status(ErrorCode::kNotFound, "the run " + run.name +
                                          " does not say how large its images are: its sparse/ has no camera, as in a "
                                          "run that was killed; give --sequence");
}

// Those that were given are an error where they do not serve, those of the sequence a note.
Status AddSfm(const EvaluationInput& run, const RunReferences& references, const EvaluationOptions& options,
              Evaluation* evaluation) {
  const bool of_sequence = references.sfm == nullptr && references.truth != nullptr && references.truth->sfm;
  if (references.sfm == nullptr && !of_sequence) return Status::Ok();
  const Result<int> width_px = WidthPx(run, references.truth);
  if (!width_px.ok()) return width_px.status();
  const SfmPoints& sfm = of_sequence ? *references.truth->sfm : *references.sfm;
  Status status = AddSfmError(run, sfm, *width_px, options, evaluation);
  if (status.ok() || !of_sequence) return status;
  evaluation->notes.push_back(status.message());
  return Status::Ok();
}

Status AddDense(const EvaluationInput& run, const RunReferences& references, const EvaluationOptions& options,
                Evaluation* evaluation) {
  if (references.surface_path.empty()) return Status::Ok();
  if (references.truth == nullptr)
    return {ErrorCode::kNotFound, "a surface is compared with the depth images of a sequence; give --sequence"};
  const auto surface = ReadSurfaceFolder(references.surface_path);
  if (!surface.ok()) return surface.status();
  auto dense = ComputeDenseError(*surface, run, *references.truth->sequence, options.points.scale);
  if (dense.status().code() == ErrorCode::kInsufficient) {  // as of other parts without truth
    evaluation->notes.push_back(dense.status().message());
    return Status::Ok();
  }
  if (!dense.ok()) return dense.status();
  evaluation->dense = *std::move(dense);
  if (const Status status = CheckSurfaceOfRun(*surface, run.name); !status.ok())
    evaluation->notes.push_back(status.message());
  // The images are read once more, from their beginning.
  const auto images = OpenSequence(references.truth->request);
  if (!images.ok()) return images.status();
  std::unique_ptr<MaterialTruth> opened;  // where no other part has asked for it
  MaterialTruth* material = nullptr;
  if (references.truth->material.ok()) {
    material = references.truth->material->get();
  } else if (auto truth = OpenMaterialTruth(references.truth->request.image_path.string()); truth.ok()) {
    opened = *std::move(truth);
    material = opened.get();
  }
  const auto textured = ComputeDenseCompleteness(*surface, images->get(), material, {});
  if (!textured.ok()) return textured.status();
  evaluation->dense->textured = *textured;
  return Status::Ok();
}

}  // namespace

Result<OpenedTruth> OpenTruth(const SequenceRequest& request, const EvaluationOptions& options) {
  OpenedTruth truth;
  truth.request = request;
  Result<std::unique_ptr<Sequence>> sequence = OpenSequence(request);
  if (!sequence.ok()) return sequence.status();
  truth.sequence = *std::move(sequence);
  if (options.Wants(EvaluationPart::kMaterial) || options.Wants(EvaluationPart::kTracks))
    truth.material = OpenMaterialTruth(request.image_path.string());
  if (!options.parts.empty()) return truth;
  auto sfm = ReadSfmPointsOfSequence(request.image_path);
  if (!sfm.ok()) return sfm.status();
  if (!sfm->empty()) truth.sfm = *std::move(sfm);
  return truth;
}

Result<Evaluation> EvaluateTrackFile(const TrackFileOptions& file, const OpenedTruth& truth) {
  const auto tracks = ReadTracksOfSequence(file, truth.request);
  if (!tracks.ok()) return tracks.status();
  const Result<MaterialTruth*> material =
      truth.material.ok() ? Result<MaterialTruth*>(truth.material->get()) : truth.material.status();
  auto evaluation =
      EvaluateTracks(file.path, tracks->tracks, truth.sequence->size(), truth.sequence->camera(), material);
  if (!evaluation.ok()) return evaluation;
  evaluation->sequence = truth.request.image_path.string();
  evaluation->notes = tracks->notes;
  return evaluation;
}

Result<SfmPoints> OpenSfmPoints(const std::filesystem::path& path, const Sequence* sequence) {
  std::error_code error;
  if (!std::filesystem::is_directory(path, error)) return ReadSfmPoints(path);
  if (sequence == nullptr)
    return Status(ErrorCode::kNotFound,
                  "the images of the model " + path.string() + " belong to frames by their names; give --sequence");
  return ReadSfmModel(path, *sequence);
}

Result<Evaluation> EvaluateRun(const std::string& run_path, const OpenedTruth& truth, const EvaluationOptions& options,
                               const JobProgress& progress) {
  return EvaluateRun(run_path, RunReferences{.truth = &truth}, options, progress);
}

Result<Evaluation> EvaluateRun(const std::string& run_path, const RunReferences& references,
                               const EvaluationOptions& options, const JobProgress& progress) {
  const Result<EvaluationInput> run = ReadInput(run_path, references.truth, options);
  if (!run.ok()) return run.status();
  Result<Evaluation> evaluation = references.truth != nullptr
                                      ? EvaluateWithTruth(*run, *references.truth, options, progress)
                                      : EvaluateWithoutTruth(*run, options);
  if (!evaluation.ok()) return evaluation;
  if (Status status = AddSfm(*run, references, options, &*evaluation); !status.ok()) return status;
  if (Status status = AddDense(*run, references, options, &*evaluation); !status.ok()) return status;
  if (references.other_runs.empty()) return evaluation;
  const Result<int> width_px = WidthPx(*run, references.truth);
  if (!width_px.ok()) return width_px.status();
  for (const std::string& other_path : references.other_runs) {
    const Result<EvaluationInput> other = ReadInput(other_path, references.truth, options);
    if (!other.ok()) return other.status();
    if (Status status = AddConsistency(*run, *other, *width_px, options, &*evaluation); !status.ok()) return status;
  }
  return evaluation;
}

Result<Evaluation> EvaluateRun(const EvaluationRequest& request, const EvaluationOptions& options,
                               const JobProgress& progress) {
  std::optional<OpenedTruth> truth;
  if (!request.sequence_path.empty()) {
    auto opened =
        OpenTruth(request.run_path.empty()
                      ? SequenceRequest{.image_path = request.sequence_path, .camera_path = request.camera_path}
                      : SequenceOfRun(request.run_path, request.sequence_path, request.camera_path).Whole(),
                  options);
    if (!opened.ok()) return opened.status();
    truth = *std::move(opened);
  }
  if (request.run_path.empty() && truth) return EvaluateTrackFile(request.track_file, *truth);
  std::optional<SfmPoints> sfm;
  if (!request.sfm_path.empty()) {
    auto opened = OpenSfmPoints(request.sfm_path, truth ? truth->sequence.get() : nullptr);
    if (!opened.ok()) return opened.status();
    sfm = *std::move(opened);
  }
  return EvaluateRun(request.run_path,
                     {truth ? &*truth : nullptr, sfm ? &*sfm : nullptr, request.other_runs, request.surface_path},
                     options, progress);
}

}  // namespace pliant
