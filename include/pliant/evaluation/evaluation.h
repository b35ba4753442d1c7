// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A run against the truth of its sequence: surface error, camera error, survival of the tracks, as values, and as a
// table, JSON or CSV for printing. The run may come from a folder or straight from the tracker's frame reports.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/datasets/sequence.h"
#include "pliant/evaluation/surface_error.h"
#include "pliant/evaluation/track_survival.h"
#include "pliant/evaluation/trajectory_error.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/tracking/frame_report.h"

namespace pliant {

// One frame of a run. Points and poses in map units, world frame.
struct EvaluationFrame {
  int frame_idx = 0;  // the sequence's own number
  double timestamp_s = 0;
  std::optional<Rigid3> cam_from_world;        // nothing: not tracked
  std::vector<PointObservation> observations;  // sorted by id
};

struct EvaluationInput {
  std::string name;                     // for messages: the run's folder
  std::vector<EvaluationFrame> frames;  // every frame read, in order
};

// Takes over what the evaluation needs of a frame report.
EvaluationFrame FrameFromReport(const FrameReport& report);

// Reads a run folder. Other programs' results without frames.csv count their poses' frames as the frames read. Errors
// as io's ReadRun; rows of a killed run's last, unfinished frame are left out.
Result<EvaluationInput> ReadEvaluationInput(const std::string& run_path);

struct EvaluationOptions {
  SurfaceErrorOptions surface;
  TrajectoryErrorOptions trajectory;

  void List(OptionTable& table);  // groups SurfaceError, TrajectoryError
};

struct Evaluation {
  std::string run;
  std::optional<SurfaceError> surface;        // where the sequence has depth
  std::optional<TrajectoryError> trajectory;  // where it has poses
  TrackSurvival survival;
  std::vector<std::string> notes;  // why a part is missing, one sentence each
};

// Fails with kMismatch when run and sequence do not belong together (a frame that the sequence does not have, or of
// another time: the sentence says which), kInsufficient when no frame was tracked, kNotFound when the sequence has
// neither depth nor poses, and with what Depth reports. `sequence` is used for its truth alone: open it without
// start, end and stride.
Result<Evaluation> Evaluate(const EvaluationInput& run, const Sequence& sequence, const EvaluationOptions& options);

// About twenty lines for a person; figures beside their null.
std::string EvaluationTable(const Evaluation& evaluation);
// Every figure by name; per-frame values in `frames`.
std::string EvaluationJson(const Evaluation& evaluation);
// One row a frame read, header first: frame, tracked, alive_of_first, surface and camera errors (empty where none).
std::string EvaluationCsv(const Evaluation& evaluation);

}  // namespace pliant
