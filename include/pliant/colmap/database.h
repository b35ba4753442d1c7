// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// COLMAP's database (SQLite) as a source of point tracks: the keypoints of images, and which of them its geometric
// verification matched. Versions 3.8 and later.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/status.h"

namespace pliant::colmap {

struct DatabaseImage {
  std::string name;
  std::uint64_t width = 0;  // of its camera
  std::uint64_t height = 0;
  std::vector<Eigen::Vector2d> keypoints;  // (0, 0) is the center of the first pixel, as everywhere in Pliant
};

// The inlier matches of two images.
struct DatabaseMatches {
  std::size_t image_a = 0;  // places in Database::images
  std::size_t image_b = 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> keypoints;  // of a, of b
};

struct Database {
  std::vector<DatabaseImage> images;     // by COLMAP's image id
  std::vector<DatabaseMatches> matches;  // by pair of images; two_view_geometries of the database
};

// Reads nothing but. Fails with kNotFound, and with kUnreadable for a file that is no database of COLMAP or is damaged.
Result<Database> ReadDatabase(const std::string& path);

}  // namespace pliant::colmap
