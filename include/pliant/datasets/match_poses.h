// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Another system's poses know times, not frames: which frame of a sequence each of them belongs to.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/datasets/sequence.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/io/trajectory.h"

namespace pliant {

struct MatchedPoses {
  std::map<int, Rigid3> world_from_cam;  // by frame
  std::vector<std::string> notes;        // sentences: poses that are left out, times in another unit than seconds
};

// Gives each pose to the frame nearest in time, if it is not further than `max_difference_s`; of several poses near one
// frame the nearest is taken. Times that come to more frames when they are read as milli-, micro- or nanoseconds are
// read so. `name` is the poses' in messages. Fails with kMismatch if the sequence has no times, if no pose is near a
// frame, if hardly one of several is near one of several frames, by chance, or if the poses lie anywhere between the
// frames and are not more than these: they have another rate. Poses may be fewer than the frames, at every n-th or any
// of them, at jittered times, off by a constant, or more of another device at times of its own.
Result<MatchedPoses> MatchPoses(std::span<const TimedPose> poses, const Sequence& sequence, double max_difference_s,
                                const std::string& name);

}  // namespace pliant
