// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Points in the JSON of the STIR challenge (Schmidt et al., STIR: Surgical Tattoos in Infrared, TMI 2024; its metrics
// are in github.com/athaddius/STIRMetrics): an object whose names are recordings and whose values are lists of points,
//   {"/data/0/left/seq00": [[160, 604], [712, 330]], ...}
// with [x, y] of the left image, px, (0, 0) being the center of the first pixel; or with [x, y, z] in the frame of the
// left camera, mm. Where the labelled points are at the start and at the end of a recording is a file each, and where a
// tracker says that those of the start are at the end is a third one. Points at the end are in no order.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/status.h"

namespace pliant {

struct StirPoints {
  int dimensions = 2;                                                // numbers of every point: 2 or 3
  std::map<std::string, std::vector<Eigen::Vector3d>> of_recording;  // z is 0 where there are two
};

// Fails with kNotFound and kUnreadable (no JSON of this form, numbers that are not finite, points of different
// lengths).
Result<StirPoints> ReadStirPoints(const std::string& path);

// Fails with kUnwritable.
Status WriteStirPoints(const StirPoints& points, const std::string& path);

}  // namespace pliant
