// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A run against the truth of its sequence: surface error, material error, camera error, error of the first map,
// survival of the tracks, as values. report.h prints them.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/base/job_progress.h"
#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/datasets/sequence.h"
#include "pliant/evaluation/dense_error.h"
#include "pliant/evaluation/first_map_error.h"
#include "pliant/evaluation/material_error.h"
#include "pliant/evaluation/point_error.h"
#include "pliant/evaluation/relative_depth.h"
#include "pliant/evaluation/reprojection_error.h"
#include "pliant/evaluation/run_consistency.h"
#include "pliant/evaluation/run_input.h"
#include "pliant/evaluation/sfm_error.h"
#include "pliant/evaluation/surface_truth.h"
#include "pliant/evaluation/track_error.h"
#include "pliant/evaluation/track_error_3d.h"
#include "pliant/evaluation/track_survival.h"
#include "pliant/evaluation/trajectory_error.h"
#include "pliant/evaluation/uncertainty_error.h"

namespace pliant {

enum class EvaluationPart { kSurface, kMaterial, kCamera, kFirstMap, kTracks };

template <>
struct EnumNames<EvaluationPart> {
  static constexpr std::array kNames = {std::pair{EvaluationPart::kSurface, std::string_view("surface")},
                                        std::pair{EvaluationPart::kMaterial, std::string_view("material")},
                                        std::pair{EvaluationPart::kCamera, std::string_view("camera")},
                                        std::pair{EvaluationPart::kFirstMap, std::string_view("first_map")},
                                        std::pair{EvaluationPart::kTracks, std::string_view("tracks")}};
};

struct EvaluationOptions {
  // None: all that the sequence has truth for, and a note where it has none. Those named are computed alone, and one
  // that cannot be is an error.
  std::vector<EvaluationPart> parts;
  SurfaceSource surface_from = SurfaceSource::kAny;
  MatchingOptions matching;
  PointErrorOptions points;
  TrajectoryErrorOptions trajectory;
  SfmErrorOptions sfm;
  RunConsistencyOptions consistency;

  bool Wants(EvaluationPart part) const;
  void List(OptionTable& table);  // groups Evaluation, PointError, TrajectoryError, SfmError, Consistency
};

// How far a run is from another one of the same recording.
struct RunConsistency {
  std::string other_run;
  std::optional<RelativeDepthError> depths;  // CompareRuns; nothing: they have no points at the same pixels
  std::optional<TrajectoryError> path;       // CompareCameraPaths; nothing: too few poses, or a camera that never moves
};

struct Evaluation {
  std::string run;
  std::string sequence;                           // for reports; the caller's word for it, may be empty
  std::optional<PointError> surface;              // where the sequence has depth
  std::optional<UncertaintyError> uncertainty;    // of `surface`, where the run says how certain its points are
  std::optional<MaterialError> material;          // where it knows its material
  std::optional<TrajectoryError> trajectory;      // where it has poses
  std::optional<FirstMapError> first_map;         // where it has depth and the run says which frames it is from
  std::optional<TrackError> tracks;               // in the images, where it knows its material
  std::optional<TrackError3d> tracks_3d;          // in space, likewise; tracks of a file have none
  std::optional<ReprojectionError> reprojection;  // where it has points
  std::optional<RelativeDepthError> sfm;          // where there are points of structure from motion
  std::vector<RunConsistency> consistency;        // with the other runs that were given
  std::optional<DenseError> dense;                // of the surface that was made of the run, where one was given
  TrackSurvival survival;
  std::optional<double> run_seconds;  // that the run took, where it says so
  std::vector<std::string> notes;     // why a part is missing, what was left out; one sentence each
};

// All but `sfm`, `dense` and `consistency`, which are added where they are asked for.
// `sequence` is used for its truth alone: open it without start, end and stride. `material` is the truth of its
// material, not null, or why there is none; `surface` that of its surface, null for its depth images. Fails with
// kMismatch when run and sequence do not belong together (CheckBelongsTo), kInsufficient when no frame was tracked,
// kNotFound when the sequence has not the truth for a part or a protocol that
// was asked for; with what a part reports that was asked for, and with what the truth reports when it cannot be read.
// `progress` is told of the frames (task "evaluate").
Result<Evaluation> Evaluate(const EvaluationInput& run, const Sequence& sequence,
                            const Result<MaterialTruth*>& material, const EvaluationOptions& options,
                            SurfaceTruth* surface = nullptr, const JobProgress& progress = {});

// What can be said of a run without its sequence: survival, and reprojection where its folder has its camera. Fails
// with kInsufficient when no frame was tracked, and with kNotFound where a part was asked for.
Result<Evaluation> EvaluateWithoutTruth(const EvaluationInput& run, const EvaluationOptions& options);

// What can be said of tracks alone, `frames` being all of the sequence: their error and survival. Fails as
// ComputeTrackError, or as `material`.
Result<Evaluation> EvaluateTracks(const std::string& name, std::span<const PixelTrack> tracks, int frames,
                                  const Camera& camera, const Result<MaterialTruth*>& material);

// Adds the error against points of structure from motion. Fails as ComputeSfmError.
Status AddSfmError(const EvaluationInput& run, const SfmPoints& sfm, int width_px, const EvaluationOptions& options,
                   Evaluation* evaluation);

// Adds the comparison with another run, by depths and camera path, or by one of them. Fails as CompareRuns where
// there is neither.
Status AddConsistency(const EvaluationInput& run, const EvaluationInput& other, int width_px,
                      const EvaluationOptions& options, Evaluation* evaluation);

}  // namespace pliant
