// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Camera paths in TUM's text format: `timestamp tx ty tz qx qy qz qw` a line, world_from_camera, seconds and
// millimetres (or map units). Lines that start with # are comments.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

struct TimedPose {
  double timestamp_s = 0;
  Rigid3 world_from_cam;
};

// Reads a whole file. Fails with kNotFound, or with kUnreadable and the line's number for a line that is not eight
// finite numbers, whose quaternion is not of unit length within 1 %, or whose time is not after the one before.
Result<std::vector<TimedPose>> ReadTumTrajectory(const std::string& path);

// One line for a file that grows, in WriteTumTrajectory's precision, with its line end.
void AppendTumLine(std::string* out, double timestamp_s, const Rigid3& world_from_cam);

// Writes 8 columns, single spaces between them: times and positions to 1e-6, quaternions to 1e-9. Fails with
// kUnwritable.
Status WriteTumTrajectory(const std::string& path, std::span<const TimedPose> poses);

}  // namespace pliant
