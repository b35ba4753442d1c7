// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The frames of parts of a recording as those of the joined run.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "pipeline/part_joiner.h"
#include "pipeline/run_parts.h"
#include "pliant/base/ids.h"
#include "pliant/geometry/sim3.h"
#include "pliant/scene/frame_report.h"

namespace pliant {

// Numbers submaps and points anew, in the order in which they come.
class JoinedReports {
 public:
  // Keeps both.
  JoinedReports(const std::vector<RunPart>& parts, const PartJoiner& joiner) : parts_(parts), joiner_(joiner) {}

  // The frame as this part has it, with what the part observed in it. Frames are asked for in growing order.
  FrameReport Report(std::size_t part_idx, int frame_idx, std::vector<PointObservation> observations);

 private:
  void AddEarlierFirstMap(const RunPart& part, int submap, FrameReport* report);
  std::pair<PointId, bool> JoinedId(std::size_t part_idx, PointId id);
  void Take(std::size_t part_idx, const Sim3& root_from_submap, std::vector<PointObservation> observations,
            FrameReport* report);

  const std::vector<RunPart>& parts_;
  const PartJoiner& joiner_;
  std::map<SubmapKey, int> numbers_;                        // in the joined run, by root
  std::set<int> begun_;                                     // of these, that have a frame
  int submap_ = 0;                                          // of the last frame
  std::map<std::pair<std::size_t, PointId>, PointId> ids_;  // by part and the id there
};

}  // namespace pliant
