// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The only file that includes Assimp.
#include "simulation/mesh_file.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include <Eigen/Geometry>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <opencv2/imgproc.hpp>

#include "datasets/image_file.h"
#include "pliant/base/child_call.h"
#include "pliant/base/state_archive.h"

namespace pliant::simulation {
namespace {

namespace fs = std::filesystem;

// The vertices and triangles of one of the file's meshes, behind those that there are.
Status Append(const std::string& path, const aiMesh& mesh, bool with_uv, MeshFile& out) {
  const auto first = static_cast<std::uint32_t>(out.vertices.size());
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D& v = mesh.mVertices[i];
    out.vertices.emplace_back(v.x, v.y, v.z);
    if (!out.vertices.back().allFinite())
      return {ErrorCode::kUnreadable, "the mesh " + path + " has a vertex that is not a finite number (" +
                                          std::to_string(i) + "); export it again"};
    if (with_uv) {
      const bool has = mesh.HasTextureCoords(0);
      out.uv.emplace_back(has ? mesh.mTextureCoords[0][i].x : 0.0F, has ? mesh.mTextureCoords[0][i].y : 0.0F);
    }
  }
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices != 3) continue;
    const std::array<std::uint32_t, 3> t = {first + face.mIndices[0], first + face.mIndices[1],
                                            first + face.mIndices[2]};
    const Eigen::Vector3d& a = out.vertices[t[0]];
    if ((out.vertices[t[1]] - a).cross(out.vertices[t[2]] - a).squaredNorm() > 0) out.triangles.push_back(t);
  }
  return Status::Ok();
}

// Assimp takes over what a file says of its faces as it is, and its further steps fall over faces without corners and
// corners that are no vertices.
Status CheckFaces(const std::string& path, const aiScene& scene) {
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
    const aiMesh& mesh = *scene.mMeshes[i];
    for (unsigned k = 0; k < mesh.mNumFaces; ++k) {
      const aiFace& face = mesh.mFaces[k];
      const bool right = face.mNumIndices > 0 && std::all_of(face.mIndices, face.mIndices + face.mNumIndices,
                                                             [&](unsigned index) { return index < mesh.mNumVertices; });
      if (!right)
        return {ErrorCode::kUnreadable, "face " + std::to_string(k) + " of the mesh " + path +
                                            " has no corners, or one that is not a vertex; export it again"};
    }
  }
  return Status::Ok();
}

// Assimp looks for the end of a PLY's header for ever where there is none.
Status CheckPlyHeader(const std::string& path) {
  constexpr int kMostLines = 10000;
  std::ifstream file(path, std::ios::binary);
  std::string line;
  if (!std::getline(file, line) || (!line.starts_with("ply") && !line.starts_with("PLY"))) return Status::Ok();
  for (int k = 0; k < kMostLines && std::getline(file, line); ++k) {
    if (line.substr(0, line.find_last_not_of(" \t\r") + 1) == "end_header") return Status::Ok();
  }
  return {ErrorCode::kUnreadable, "the mesh " + path + " is a PLY whose header has no end; export it again"};
}

// The path of the picture that the first material with one names, beside the mesh; empty: none does.
std::string PicturePath(const std::string& path, const aiScene& scene) {
  for (unsigned i = 0; i < scene.mNumMaterials; ++i) {
    aiString name;
    if (scene.mMaterials[i]->GetTexture(aiTextureType_DIFFUSE, 0, &name) != aiReturn_SUCCESS) continue;
    std::string relative = name.C_Str();
    std::replace(relative.begin(), relative.end(), '\\', '/');
    return (fs::path(path).parent_path() / relative).string();
  }
  return {};
}

Status ReadPicture(const std::string& path, MeshFile& mesh) {
  const std::string what = "the picture " + mesh.picture_path + " of the mesh " + path;
  std::error_code error;
  if (!fs::exists(mesh.picture_path, error))
    return {ErrorCode::kNotFound, what + " is not there; put it there, or take it out of the mesh's material"};
  const auto read = ReadImage(mesh.picture_path);
  if (!read.ok()) return {read.status().code(), what + ": " + read.status().message()};
  mesh.image = *read;
  if (mesh.image.channels() == 1) cv::cvtColor(*read, mesh.image, cv::COLOR_GRAY2BGR);
  return Status::Ok();
}

void Transfer(StateArchive& archive, MeshFile& mesh) {
  archive(mesh.vertices, mesh.uv, mesh.triangles, mesh.picture_path);
}

std::string Unreadable(const std::string& path) { return "the mesh " + path + " cannot be read as OBJ, PLY or STL"; }

}  // namespace

Result<MeshFile> ParseMeshFile(const std::string& path) {
  if (Status status = CheckPlyHeader(path); !status.ok()) return status;
  Assimp::Importer importer;
  // What a renderer would want (normals, colors) only keeps vertices of one position apart.
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_COLORS |
                                                          aiComponent_TANGENTS_AND_BITANGENTS |
                                                          aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const Status no_faces(ErrorCode::kInsufficient,
                        "the mesh " + path + " has no faces; a cloud of points shows nothing");
  const auto unreadable = [&] {
    return Status(ErrorCode::kUnreadable, Unreadable(path) + ": " + importer.GetErrorString());
  };
  const aiScene* scene = importer.ReadFile(path, 0);
  if (scene == nullptr) return unreadable();
  if (std::none_of(scene->mMeshes, scene->mMeshes + scene->mNumMeshes,
                   [](const aiMesh* mesh) { return mesh->mNumFaces > 0; }))
    return no_faces;
  if (Status status = CheckFaces(path, *scene); !status.ok()) return status;
  scene =
      importer.ApplyPostProcessing(aiProcess_RemoveComponent | aiProcess_Triangulate | aiProcess_PreTransformVertices |
                                   aiProcess_JoinIdenticalVertices | aiProcess_SortByPType);
  if (scene == nullptr) return unreadable();
  bool with_uv = false;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) with_uv = with_uv || scene->mMeshes[i]->HasTextureCoords(0);
  MeshFile mesh;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i)
    if (Status status = Append(path, *scene->mMeshes[i], with_uv, mesh); !status.ok()) return status;
  if (mesh.triangles.empty()) return no_faces;
  if (with_uv) mesh.picture_path = PicturePath(path, *scene);
  return mesh;
}

Result<MeshFile> ReadMeshFile(const std::string& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error))
    return {ErrorCode::kNotFound, "there is no mesh file " + path + "; check Scene.mesh_path"};
  // What Assimp takes for meshes of millions of triangles, twice.
  const auto size = static_cast<std::int64_t>(fs::file_size(path, error));
  const ChildLimits limits = {.cpu_seconds = 10 + static_cast<int>(size / 1000000),
                              .memory_bytes = 500000000 + 40 * size};
  Result<std::string> bytes = CallInChild(Unreadable(path), limits, [&]() -> Result<std::string> {
    Result<MeshFile> parsed = ParseMeshFile(path);
    if (!parsed.ok()) return parsed.status();
    StateArchive archive;
    Transfer(archive, *parsed);
    return archive.bytes();
  });
  if (!bytes.ok()) return bytes.status();
  MeshFile mesh;
  StateArchive archive = StateArchive::Reading(std::move(*bytes));
  Transfer(archive, mesh);
  if (!archive.ok()) return {ErrorCode::kUnreadable, Unreadable(path) + ": its reader's answer breaks off"};
  if (!mesh.picture_path.empty())
    if (Status status = ReadPicture(path, mesh); !status.ok()) return status;
  return mesh;
}

}  // namespace pliant::simulation
