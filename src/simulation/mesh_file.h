// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Triangle meshes from files: OBJ, PLY, STL (and what else Assimp reads).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pliant/base/status.h"

namespace pliant::simulation {

struct MeshFile {
  std::vector<Eigen::Vector3d> vertices;  // the file's unit and frame
  std::vector<Eigen::Vector2d> uv;        // of a vertex; empty: the file has none
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::string picture_path;  // of the first material's diffuse picture; empty: it names none
  cv::Mat image;             // that picture, CV_8UC3; empty: there is none, or it was not read
};

// What Assimp reads of a mesh, in this process, and without the picture. Vertices that agree in position and uv are
// one. Polygons are cut into triangles; points, lines and triangles without area are left out. Fails with kUnreadable
// (not a mesh, a vertex that is not a finite number) and kInsufficient (no faces); the sentence names the file.
Result<MeshFile> ParseMeshFile(const std::string& path);

// The same in a child process (CallInChild), whatever Assimp makes of the file, and with the picture. Fails also with
// kNotFound (no such file, or its picture is missing) and kUnreadable (the child crashed, or took more time or memory
// than a file of its size needs, or the picture cannot be decoded).
Result<MeshFile> ReadMeshFile(const std::string& path);

}  // namespace pliant::simulation
