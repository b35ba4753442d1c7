// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The rows of a run folder: observations as they are written, and all rows once more where submaps were merged.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "pliant/base/status.h"
#include "pliant/geometry/sim3.h"
#include "pliant/io/canonical_model.h"
#include "pliant/scene/frame_report.h"

namespace pliant {

class StateArchive;

// A row of observations.csv.
void AppendObservation(std::string* out, int frame_idx, const PointObservation& o);

// Whose world a frame is in.
struct RunFrameWorld {
  int frame_idx = 0;
  int written_submap = 0;        // as its rows on disk say
  int submap = 0;                // as it is now
  std::optional<Sim3> moved_by;  // from the one to the other; nothing: it is the same world
};

void Serialize(StateArchive& archive, RunFrameWorld& world);

// Brings the rows of trajectory.txt, observations.csv and frames.csv into the worlds that their frames have now; where
// nothing has changed nothing is written. `worlds` has an entry for every row of frames.csv, `images` one for every
// line of trajectory.txt, with its pose as it is now. The files are replaced together, or left as they are. Fails with
// kUnwritable, or as the reading of the rows does.
Status MoveRunRows(const std::string& run_path, std::span<const RunFrameWorld> worlds,
                   std::span<const CanonicalImage> images);

// Keeps the files of rows as they are beside the run's checkpoint, which is there, since they may be replaced by
// others; and takes what was kept back. Fails with kUnwritable.
Status KeepRows(const std::string& run_path);
Status TakeKeptRows(const std::string& run_path);

}  // namespace pliant
