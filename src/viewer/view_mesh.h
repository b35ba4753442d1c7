// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The meshes of surface folders beside the runs that they were made of.
#pragma once

#include <vector>

#include "pliant/base/status.h"
#include "pliant/geometry/sim3.h"
#include "pliant/io/gltf.h"
#include "pliant/viewer/view.h"

namespace pliant {

// The meshes of the request's surfaces, those of each of its runs, in its order. Fails as ReadSurfaceFolder and ReadGlb
// do, and with kMismatch for a surface of another run.
Result<std::vector<std::vector<ViewedMesh>>> ReadMeshes(const ViewRequest& request);

// The mesh in another world.
void Move(const Sim3& other_from_world, GltfMesh* mesh);

}  // namespace pliant
