// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The frames of a run that is to be worked on further.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/io/run_map.h"
#include "pliant/io/run_reader.h"
#include "pliant/scene/frame_report.h"

namespace pliant {

// That a run that is made of the one at `run_path` is written elsewhere: neither in its place nor in its folder.
// `kind`: what is made, for the message. Fails with kInvalidArgument.
Status CheckOutsideOfRun(const std::string& run_path, const std::string& output_path, std::string_view kind);

// The frame of every pose of `run`, which was read from `path`. Fails with kMismatch for another program's result,
// whose poses belong to no frame.
Result<std::vector<int>> FramesWithPose(const std::string& path, const Run& run);

// A frame of a run whose map is `known`, as it is written again: all but its pose and its points.
FrameReport ReportOf(const RunFrame& frame, const RunMap& known);

// That a point that is in the submap `one` and in `other` is in one: frames that were written before two maps became
// one are written again at a run's end. Fails with kMismatch.
Status CheckOneSubmap(int one, int other, PointId id);

// What follows of a frame's pose, observations and new points, and the first map that `run` declared in it.
void CompleteReport(const Run& run, const Camera& camera, FrameReport* report);

}  // namespace pliant
