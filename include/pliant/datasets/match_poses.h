// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Another system's poses know times, not frames: which frame of a sequence each of them belongs to.
#pragma once

#include <map>
#include <span>
#include <string>

#include "pliant/base/status.h"
#include "pliant/datasets/sequence.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/io/trajectory.h"

namespace pliant {

struct MatchedPoses {
  std::map<int, Rigid3> world_from_cam;  // by frame
  int left_out = 0;                      // poses that are near no frame, or less near than another one
};

// Gives each pose to the frame nearest in time, if it is not further than `max_difference_s`; of several poses near one
// frame the nearest is taken. `name` is the poses' in messages. Fails with kMismatch if the sequence has no times, or
// no pose is near a frame.
Result<MatchedPoses> MatchPoses(std::span<const TimedPose> poses, const Sequence& sequence, double max_difference_s,
                                const std::string& name);

}  // namespace pliant
