// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Runs of parts of one recording.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "pliant/base/ids.h"
#include "pliant/base/job_progress.h"
#include "pliant/base/status.h"
#include "pliant/io/run_map.h"
#include "pliant/io/run_reader.h"
#include "pliant/pipeline/join_runs.h"

namespace pliant {

// What a run says; `poses` and `frames` point into `run`, so it is moved, never copied.
struct RunPart {
  std::string path;
  Run run;
  RunMap known;
  std::map<int, const RunPose*> poses;     // by frame
  std::map<int, const RunFrame*> frames;   // likewise
  std::map<PointId, PointId> same_points;  // ids in the part before of points that this one has, too

  const RunDescription& description() const { return run.summary->description; }
  int first_frame() const { return frames.begin()->first; }
  int last_frame() const { return frames.rbegin()->first; }
};

// All parts, in the order of their first frames. Fails where one cannot be read, where they are not of one recording,
// and where no frame of them has a pose.
Result<std::vector<RunPart>> ReadParts(const JoinRequest& request, const JobProgress& progress);

// The part that each frame is taken from: of two that have its pose the earlier one up to the middle of their overlap.
std::map<int, std::size_t> PartOfFrames(const std::vector<RunPart>& parts);

}  // namespace pliant
