// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A mesh as a Wavefront OBJ file, with its texture where there is one.
#pragma once

#include <string>

#include "pliant/base/status.h"
#include "pliant/scene/mesh.h"

namespace pliant {

// `material_file`, relative to the file, has the material `tissue`; empty: the vertices' colors follow their positions,
// as MeshLab and Blender read them. Fails with kUnwritable.
Status WriteObj(const std::string& path, const Mesh& mesh, const std::string& material_file);

// The material `tissue`: the texture image at `texture_file`, relative to the file. Fails with kUnwritable.
Status WriteObjMaterial(const std::string& path, const std::string& texture_file);

}  // namespace pliant
