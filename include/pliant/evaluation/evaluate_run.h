// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// From a run folder, and the paths of what it is compared with, to an evaluation.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pliant/base/job_progress.h"
#include "pliant/base/status.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/datasets/sequence.h"
#include "pliant/datasets/sequence_tracks.h"
#include "pliant/datasets/sfm_points.h"
#include "pliant/evaluation/evaluation.h"

namespace pliant {

// A sequence opened for its truth. Opening a simulated one builds its scene again, so it serves several runs.
struct OpenedTruth {
  SequenceRequest request;
  std::unique_ptr<Sequence> sequence;
  Result<std::unique_ptr<MaterialTruth>> material =
      Status(ErrorCode::kInvalidArgument,
             "a file of tracks is compared by the part tracks, which Evaluation.parts leaves out");
  std::optional<SfmPoints> sfm;  // nothing: the sequence has none, or other parts were asked for by name
};

// All of the sequence: without start, end and stride. Fails as OpenSequence and ReadSfmPointsOfSequence do; without the
// truth of the material it is open all the same.
Result<OpenedTruth> OpenTruth(const SequenceRequest& request, const EvaluationOptions& options);

// Points of structure from motion at `path`: a CSV like sfm_points.csv, or the folder of a COLMAP model, which needs
// `sequence`, null: there is none. Fails as ReadSfmPoints and ReadSfmModel, and with kNotFound for a model without a
// sequence.
Result<SfmPoints> OpenSfmPoints(const std::filesystem::path& path, const Sequence* sequence);

// Reads the run and evaluates, against points of structure from motion too where the sequence has some. Fails as
// ReadEvaluationInput and Evaluate do.
Result<Evaluation> EvaluateRun(const std::string& run_path, const OpenedTruth& truth, const EvaluationOptions& options,
                               const JobProgress& progress = {});

// Evaluates a file of tracks on its own, in all frames of the sequence. Fails as ReadTracksOfSequence and
// EvaluateTracks.
Result<Evaluation> EvaluateTrackFile(const TrackFileOptions& file, const OpenedTruth& truth);

// What else a run may be compared with, each of it optional.
struct RunReferences {
  const OpenedTruth* truth = nullptr;            // of the run's sequence
  const SfmPoints* sfm = nullptr;                // else those of `truth`
  std::span<const std::string> other_runs = {};  // folders of runs of the same recording
  std::string surface_path = {};                 // folder of a surface that was made of the run; empty: none
};

// The same with what there is. Fails also as ReadSurfaceFolder, ComputeDenseError, EvaluateWithoutTruth, AddSfmError
// (`references.sfm`; those of the sequence leave a note, and so does a surface without pixels of true depth) and
// AddConsistency, and with kNotFound where neither run nor sequence says how large the images are.
Result<Evaluation> EvaluateRun(const std::string& run_path, const RunReferences& references,
                               const EvaluationOptions& options, const JobProgress& progress = {});

// The same by the paths of all of it.
struct EvaluationRequest {
  std::string run_path;
  std::string sequence_path = {};  // of the truth, or without one; empty: it is compared with the others alone
  std::string camera_path = {};    // the calibration of the sequence; empty: the one that belongs to it
  std::string sfm_path = {};       // as OpenSfmPoints; empty: those of the sequence
  std::string surface_path = {};   // as RunReferences
  std::vector<std::string> other_runs = {};  // likewise
  TrackFileOptions track_file = {};          // where run_path is empty: compared with the truth instead of a run
};
Result<Evaluation> EvaluateRun(const EvaluationRequest& request, const EvaluationOptions& options,
                               const JobProgress& progress = {});

}  // namespace pliant
