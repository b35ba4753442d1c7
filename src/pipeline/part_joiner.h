// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Where the submaps of parts of a recording lie in one world.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/run_joint.h"
#include "pipeline/run_parts.h"
#include "pliant/base/status.h"
#include "pliant/geometry/sim3.h"
#include "pliant/pipeline/join_runs.h"

namespace pliant {

// A submap of a part: the part's index, the submap's number there.
using SubmapKey = std::pair<std::size_t, int>;

// Where a submap went: its own world, or an earlier one's.
struct PlacedSubmap {
  SubmapKey root;
  Sim3 root_from_submap;
};

// Joins the submaps of consecutive parts.
class PartJoiner {
 public:
  // Keeps both.
  PartJoiner(std::vector<RunPart>* parts, const JoinOptions& options);

  // The part `after` to the one before it. A submap goes where most of its frames are shared. Fails where a run's
  // observations cannot be read; a submap that cannot be joined stays a world of its own.
  Status Join(std::size_t after);

  const PlacedSubmap& PlaceOf(const SubmapKey& key) const { return placed_.at(key); }
  std::vector<RunJoint> TakeJoints() { return std::move(joints_); }

 private:
  RunJoint Failed(std::size_t after, std::size_t frames, const std::string& why) const;
  void JoinSubmaps(const SubmapKey& after, const SubmapKey& before, const std::vector<SharedFrame>& frames);

  std::vector<RunPart>& parts_;
  const JoinOptions& options_;
  std::map<SubmapKey, PlacedSubmap> placed_;
  std::vector<RunJoint> joints_;
};

}  // namespace pliant
