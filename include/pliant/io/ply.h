// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Colored points, or a mesh, as a PLY file (binary, little-endian; x y z float, red green blue uchar, and, where it is
// known, sigma float: the standard deviation of a point's distance from the camera), which MeshLab, CloudCompare
// and Open3D open.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/status.h"
#include "pliant/scene/frame_report.h"
#include "pliant/scene/mesh.h"

namespace pliant {

// `sigmas` has one entry a point, 0 where it is not known, or none. Fails with kUnwritable.
Status WritePly(const std::string& path, std::span<const NewPoint> points, std::span<const double> sigmas = {});

// A mesh: beside that of a point, nx ny nz float and, where it has ids or views, vertex int and view uchar of every
// vertex, and faces as lists of vertex_indices. Fails with kUnwritable.
Status WritePly(const std::string& path, const Mesh& mesh);

struct PlyVertices {
  std::vector<Eigen::Vector3d> positions;  // in the file's own unit and order
  std::vector<double> sigmas;              // of the property sigma; empty: there is none
};

// In ASCII or binary little-endian, with x, y and z of the vertices as floats, by whomever it was written. Fails with
// kNotFound or kUnreadable (not such a file, damaged, or cut off).
Result<PlyVertices> ReadPlyVertices(const std::string& path);

}  // namespace pliant
