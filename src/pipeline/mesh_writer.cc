// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/mesh_writer.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <system_error>
#include <utility>

#include "pliant/base/files.h"
#include "pliant/datasets/surface_folder.h"
#include "pliant/io/obj.h"
#include "pliant/io/ply.h"
#include "pliant/surface/mesh_geometry.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr const char* kObjFolder = "obj";
constexpr const char* kVtpFolder = "vtp";
constexpr const char* kTextureName = "texture";

Status MakeFolder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  return error ? Unwritable(path) : Status::Ok();
}

// NAME, or NAME_ and a number, with an ending that we give it.
bool IsOurs(const fs::path& path) {
  std::string name = path.stem().string();
  const std::size_t number = name.find_last_not_of("0123456789");
  if (number != std::string::npos && number + 1 < name.size() && name[number] == '_') name.resize(number);
  const std::string ending = path.extension().string();
  return (name == "surface" && (ending == ".glb" || ending == ".pvd")) || (name == "undeformed" && ending == ".ply") ||
         (name == kTextureName && (ending == ".jpg" || ending == ".mtl"));
}

VtkArray ViewsOf(const MeshInFrame& now) {
  VtkArray views{"view", 1, {}};
  for (const VertexView view : now.views) views.values.push_back(static_cast<float>(view));
  return views;
}

// From the undeformed positions.
VtkArray Displacements(const Mesh& undeformed, const Mesh& now) {
  VtkArray displacement{"displacement", 3, {}};
  for (std::size_t v = 0; v < now.vertices.size(); ++v)
    for (const float d : Eigen::Vector3f(now.vertices[v] - undeformed.vertices[v])) displacement.values.push_back(d);
  return displacement;
}

std::array<VtkArray, 3> StrainArrays(const Mesh& undeformed, const Mesh& now) {
  VtkArray area_change{"area_change", 1, {}};
  VtkArray largest{"largest_stretch", 1, {}};
  VtkArray least{"least_stretch", 1, {}};
  for (const TriangleStrain& strain : Strains(undeformed.vertices, now.vertices, now.triangles)) {
    area_change.values.push_back(strain.area_change);
    largest.values.push_back(strain.largest_stretch);
    least.values.push_back(strain.least_stretch);
  }
  return {area_change, largest, least};
}

}  // namespace

std::vector<Eigen::Vector3f> DeformedMesh::Vertices() const {
  std::vector<Eigen::Vector3f> vertices;
  for (const Eigen::Vector3d& position : now.positions) vertices.push_back(position.cast<float>());
  return vertices;
}

Mesh DeformedMesh::SeenPart() const {
  Mesh mesh = undeformed;
  std::vector<bool> seen;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    mesh.vertices[v] = (cam_from_world * now.positions[v]).cast<float>();
    mesh.ids.push_back(static_cast<std::int32_t>(v));
    mesh.views.push_back(static_cast<std::uint8_t>(now.views[v]));
    seen.push_back(now.views[v] != VertexView::kOutOfView);
  }
  mesh.sigmas = now.sigmas;
  mesh = PartOfMesh(mesh, seen);
  mesh.normals = VertexNormals(mesh.vertices, mesh.triangles);
  return mesh;
}

Mesh DeformedMesh::Whole() const {
  Mesh mesh = undeformed;
  mesh.vertices = Vertices();
  mesh.normals = VertexNormals(mesh.vertices, mesh.triangles);
  mesh.sigmas = now.sigmas;
  return mesh;
}

Status MeshWriter::RemoveEarlier(const fs::path& folder) {
  std::error_code error;
  for (const char* kind : {surface::kMeshFolder, kObjFolder, kVtpFolder}) {
    fs::remove_all(folder / kind, error);
    if (error) return Unwritable(folder / kind);
  }
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (IsOurs(entry->path()) && !fs::remove(entry->path(), error)) return Unwritable(entry->path());
  return Status::Ok();
}

Status MeshWriter::WriteUndeformed(const Mesh& mesh, std::string_view texture_jpeg) {
  if (Status status = WritePly(FileName("undeformed", ".ply").string(), mesh); !status.ok() || !files_.obj)
    return status;
  const fs::path image = FileName(kTextureName, ".jpg");
  if (Status status = WriteFileAtomically(image.string(), texture_jpeg); !status.ok()) return status;
  return WriteObjMaterial(FileName(kTextureName, ".mtl").string(), image.filename().string());
}

Status MeshWriter::WriteFrame(const std::string& name, const DeformedMesh& deformed) {
  const Mesh seen = deformed.SeenPart();
  if (Status status = MakeFolder(folder_ / surface::kMeshFolder); !status.ok()) return status;
  if (Status status = WritePly((folder_ / surface::kMeshFolder / (name + ".ply")).string(), seen); !status.ok())
    return status;
  if (files_.obj) {
    if (Status status = MakeFolder(folder_ / kObjFolder); !status.ok()) return status;
    const std::string material = "../" + FileName(kTextureName, ".mtl").filename().string();
    if (Status status = WriteObj((folder_ / kObjFolder / (name + ".obj")).string(), seen, material); !status.ok())
      return status;
  }
  if (!files_.vtk) return Status::Ok();
  if (Status status = MakeFolder(folder_ / kVtpFolder); !status.ok()) return status;
  const Mesh whole = deformed.Whole();
  times_.push_back({deformed.timestamp_s, std::string(kVtpFolder) + "/" + name + ".vtp"});
  return WriteVtp((folder_ / times_.back().file).string(), whole,
                  std::array{Displacements(deformed.undeformed, whole), ViewsOf(deformed.now)},
                  StrainArrays(deformed.undeformed, whole));
}

Status MeshWriter::Finish() {
  return files_.vtk ? WritePvd(FileName("surface", ".pvd").string(), times_) : Status::Ok();
}

}  // namespace pliant
