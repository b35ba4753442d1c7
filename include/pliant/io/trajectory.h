// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Camera paths. Ours are in TUM's text format: `timestamp tx ty tz qx qy qz qw` a line, world_from_camera, seconds and
// millimeters (or map units). Those of other systems are read in KITTI's and EuRoC's too. Lines that start with # are
// comments.
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

// KITTI's poses: the twelve numbers of the matrix [R t] a line, row by row, world_from_camera; the line is the frame.
// Fails with kNotFound, or with kUnreadable and the line's number for a line that is not twelve finite numbers, or
// whose R is not a rotation within 1 %.
Result<std::vector<Rigid3>> ReadKittiPoses(const std::string& path);

// EuRoC's ground truth and what is written like it: `timestamp, px, py, pz, qw, qx, qy, qz` a line and whatever
// follows, nanoseconds. The poses are those of whatever the file is about, in EuRoC's own of the IMU. Fails as
// ReadTumTrajectory.
Result<std::vector<TimedPose>> ReadEurocTrajectory(const std::string& path);

// One line for a file that grows, in WriteTumTrajectory's precision, with its line end.
void AppendTumLine(std::string* out, double timestamp_s, const Rigid3& world_from_cam);

// Writes 8 columns, single spaces between them: times and positions to 1e-6, quaternions to 1e-9. Fails with
// kUnwritable.
Status WriteTumTrajectory(const std::string& path, std::span<const TimedPose> poses);

}  // namespace pliant
