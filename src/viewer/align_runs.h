// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Worlds brought together by camera poses in common frames.
#pragma once

#include <map>
#include <optional>

#include "pliant/geometry/rigid3.h"
#include "pliant/geometry/sim3.h"
#include "pliant/viewer/view.h"

namespace pliant {

using FramePoses = std::map<int, Rigid3>;  // world_from_cam by frame

// A run's poses in one of its worlds.
FramePoses PosesOf(const ViewedRun& run, int submap);

// The least-squares similarity from `from`'s world to that of `to`: of the cameras' centers and axes, the axes as long
// as the typical depth, so that it is certain for a camera that stands still or goes along a line as well. `scale` is
// to's unit in from's, where it is known, else that of the paths, and 1 where a camera never moves. Nothing without a
// common frame.
std::optional<Sim3> AlignWorlds(const FramePoses& from, const FramePoses& to, std::optional<double> scale,
                                double depth_in_from);

using FrameDepths = std::map<int, double>;  // median depth of the points by frame

// Of a run's frames in one of its worlds, its own unit.
FrameDepths DepthsOf(const ViewedRun& run, int submap);

double MedianOf(const FrameDepths& depths);  // 1 where there is none

// How many times as deep the frames that both have are in `to`; nothing where there is none.
std::optional<double> DepthRatio(const FrameDepths& from, const FrameDepths& to);

}  // namespace pliant
