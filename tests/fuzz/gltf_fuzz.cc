// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A surface's mesh (surface.glb).
#include <cstdlib>

#include "fuzz_input.h"
#include "pliant/io/gltf.h"

using namespace pliant;  // NOLINT(google-build-using-namespace): a file that is one function

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto read = ReadGlb(WriteFuzzFile("surface.glb", {data, size}));
  if (!read.ok()) {
    if (read.status().message().empty()) std::abort();
    return 0;
  }
  const Mesh& mesh = read->mesh;
  if (mesh.normals.size() != mesh.vertices.size() || mesh.sigmas.size() != mesh.vertices.size()) std::abort();
  if (!mesh.texture_uvs.empty() && mesh.texture_uvs.size() != mesh.triangles.size()) std::abort();
  for (const auto& triangle : mesh.triangles)
    for (const std::int32_t v : triangle)
      if (v < 0 || static_cast<std::size_t>(v) >= mesh.vertices.size()) std::abort();
  for (const MeshKey& key : read->keys)
    if (key.positions.size() != mesh.vertices.size()) std::abort();
  return 0;
}
