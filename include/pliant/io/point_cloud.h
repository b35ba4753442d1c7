// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Point clouds that others wrote: NumPy's .npy of N x 3 or more floats, .ply in ASCII or binary little-endian with x, y
// and z of its vertices, and text (.xyz, .txt, .csv) with three numbers or more a line.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/status.h"

namespace pliant {

// In the file's own unit and order; points that are not finite are left out. Fails with kNotFound, kUnreadable (not
// such a file, damaged, or cut off) or kInsufficient (no point).
Result<std::vector<Eigen::Vector3d>> ReadPointCloud(const std::string& path);

}  // namespace pliant
