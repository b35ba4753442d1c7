// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A mesh for the simulator, as OBJ, PLY or STL.
#include <array>
#include <cstdlib>
#include <string>

#include "fuzz_input.h"
#include "simulation/mesh_file.h"

using namespace pliant;  // NOLINT(google-build-using-namespace): a file that is one function

namespace {

constexpr std::array<const char*, 3> kNames = {"mesh.obj", "mesh.ply", "mesh.stl"};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const FuzzInput input(data, size, static_cast<int>(kNames.size()));
  const std::string path = WriteFuzzFile(kNames.at(static_cast<std::size_t>(input.choice)), input.bytes);
  const auto mesh = simulation::ParseMeshFile(path);
  std::filesystem::remove(path);
  if (!mesh.ok()) {
    if (mesh.status().message().empty()) std::abort();
    return 0;
  }
  if (mesh->triangles.empty() || !(mesh->uv.empty() || mesh->uv.size() == mesh->vertices.size())) std::abort();
  for (const Eigen::Vector3d& vertex : mesh->vertices)
    if (!vertex.allFinite()) std::abort();
  for (const auto& triangle : mesh->triangles)
    for (const std::uint32_t v : triangle)
      if (v >= mesh->vertices.size()) std::abort();
  return 0;
}
