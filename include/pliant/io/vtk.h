// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Meshes over time as VTK's XML files, which ParaView and 3D Slicer open: a PolyData file (.vtp, compressed) a time,
// and a collection (.pvd) that says which file is when.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/scene/mesh.h"

namespace pliant {

// A value of every vertex or triangle.
struct VtkArray {
  std::string name;
  int components = 1;
  std::vector<float> values;  // `components` an entry
};

// The mesh's normals, colors (`rgb`), `sigma` and `vertex` (ids) are written too, where it has them. Fails with
// kUnwritable.
Status WriteVtp(const std::string& path, const Mesh& mesh, std::span<const VtkArray> of_vertices,
                std::span<const VtkArray> of_triangles);

struct VtkTime {
  double time_s = 0;
  std::string file;  // relative to the collection
};

// Fails with kUnwritable.
Status WritePvd(const std::string& path, std::span<const VtkTime> times);

}  // namespace pliant
