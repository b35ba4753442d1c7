// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/view_mesh.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>

#include "pliant/base/files.h"
#include "pliant/base/text.h"
#include "pliant/datasets/surface_folder.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// The run that the surface was made of, or a copy of it; where it cannot be known since the surface is of an earlier
// version and that run is not there any more, the only run that is shown.
Result<std::size_t> RunOf(const SurfaceFolder& surface, const std::vector<std::string>& run_paths) {
  std::error_code error;
  for (std::size_t i = 0; i < run_paths.size(); ++i) {
    if (!fs::equivalent(surface.run, run_paths[i], error)) continue;
    if (Status status = CheckSurfaceOfRun(surface, run_paths[i]); !status.ok()) return status;
    return i;
  }
  const bool is_known = !surface.trajectory_checksum.empty() || Exists(surface.run.string());
  for (std::size_t i = 0; i < run_paths.size(); ++i)
    if ((is_known || run_paths.size() == 1) && CheckSurfaceOfRun(surface, run_paths[i]).ok()) return i;
  return Status(ErrorCode::kMismatch, "the surface " + Quoted(surface.path.string()) + " was made of the run " +
                                          Quoted(surface.run.string()) + ", which is not among those that are shown");
}

// surface.glb, or of several submaps surface_0.glb, surface_1.glb, ..., of which some may have no mesh.
std::vector<fs::path> MeshFilesOf(const fs::path& folder) {
  std::map<std::int64_t, fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    std::int64_t number = -1;
    constexpr std::string_view kBegin = "surface_";
    constexpr std::string_view kEnd = ".glb";
    const bool numbered =
        name.starts_with(kBegin) && name.ends_with(kEnd) && name.size() > kBegin.size() + kEnd.size() &&
        ParseInt64(std::string_view(name).substr(kBegin.size(), name.size() - kBegin.size() - kEnd.size()), &number);
    if (numbered || name == "surface.glb") files.emplace(number, entry->path());
  }
  std::vector<fs::path> sorted;
  for (auto& [number, path] : files) sorted.push_back(std::move(path));
  return sorted;
}

}  // namespace

Result<std::vector<std::vector<ViewedMesh>>> ReadMeshes(const ViewRequest& request) {
  std::vector<std::vector<ViewedMesh>> meshes(request.run_paths.size());
  for (const std::string& path : request.surface_paths) {
    const auto surface = ReadSurfaceFolder(path);
    if (!surface.ok()) return surface.status();
    const auto run = RunOf(*surface, request.run_paths);
    if (!run.ok()) return run.status();
    const std::vector<fs::path> files = MeshFilesOf(path);
    if (files.empty())
      return Status(ErrorCode::kNotFound,
                    Quoted(path) +
                        " has no surface.glb to show; make it again with pliant surface, with --Surface.gltf true and "
                        "--Surface.mesh_columns above 0");
    for (const fs::path& file : files) {
      auto mesh = ReadGlb(file.string());
      if (!mesh.ok()) return mesh.status();
      meshes[*run].push_back({.surface = *std::move(mesh)});
    }
  }
  return meshes;
}

void Move(const Sim3& other_from_world, GltfMesh* mesh) {
  const auto transform = [&](std::vector<Eigen::Vector3f>* positions) {
    for (Eigen::Vector3f& position : *positions) position = (other_from_world * position.cast<double>()).cast<float>();
  };
  transform(&mesh->mesh.vertices);
  for (MeshKey& key : mesh->keys) transform(&key.positions);
  for (float& sigma : mesh->mesh.sigmas) sigma *= static_cast<float>(other_from_world.scale);
}

}  // namespace pliant
