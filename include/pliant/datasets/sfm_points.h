// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What structure from motion reconstructed of a sequence: points, by the frames that see them, with their pixel and
// depth. In a native sequence it is the file sfm_points.csv (docs/formats.md), elsewhere a file like it or a COLMAP
// model. Depth is z along the optical axis, in the reconstruction's own unit; pixel (0, 0) is the center of the first
// one.
#pragma once

#include <filesystem>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/status.h"
#include "pliant/datasets/sequence.h"

namespace pliant {

struct SfmPoint {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double depth = 0;  // positive
};

using SfmPoints = std::map<int, std::vector<SfmPoint>>;  // by the sequence's own frame number

// A CSV with the columns frame, u_px, v_px and depth, in any order; others are ignored. Fails with kNotFound or
// kUnreadable (file and line: a column that is missing, what is not a number, a depth that is not positive).
Result<SfmPoints> ReadSfmPoints(const std::filesystem::path& path);

// The points of a COLMAP model at the keypoints of its images; those behind an image are left out. Images belong to the
// frames of `sequence`, opened without start, that have their file name, folders apart. Fails as colmap::ReadModel, and
// with kMismatch where no image belongs to a frame or the images have another size.
Result<SfmPoints> ReadSfmModel(const std::filesystem::path& folder, const Sequence& sequence);

// sfm_points.csv of the native sequence at `path`; empty where there is none. Fails as ReadSfmPoints.
Result<SfmPoints> ReadSfmPointsOfSequence(const std::filesystem::path& path);

}  // namespace pliant
