// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tiny_gltf.h>

#include "io/gltf_layout.h"
#include "pliant/base/files.h"
#include "pliant/base/text.h"
#include "pliant/io/gltf.h"

namespace pliant {
namespace gltf {
namespace {

// The values of an accessor of four bytes each, one after the other.
template <class T>
std::optional<std::vector<T>> ValuesAt(const tinygltf::Model& model, int accessor, int component_type) {
  if (accessor < 0 || static_cast<std::size_t>(accessor) >= model.accessors.size()) return std::nullopt;
  const tinygltf::Accessor& entry = model.accessors[static_cast<std::size_t>(accessor)];
  if (entry.componentType != component_type || entry.bufferView < 0 ||
      static_cast<std::size_t>(entry.bufferView) >= model.bufferViews.size())
    return std::nullopt;
  const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(entry.bufferView)];
  const std::size_t bytes = view.byteLength;
  if (model.buffers.size() != 1 || view.byteOffset > model.buffers[0].data.size() ||
      bytes > model.buffers[0].data.size() - view.byteOffset)
    return std::nullopt;
  std::vector<T> values(bytes / sizeof(T));
  if (!values.empty())
    std::memcpy(values.data(), model.buffers[0].data.data() + view.byteOffset, values.size() * sizeof(T));
  return values;
}

std::optional<std::vector<float>> FloatsAt(const tinygltf::Model& model, int accessor) {
  return ValuesAt<float>(model, accessor, TINYGLTF_COMPONENT_TYPE_FLOAT);
}

std::vector<Eigen::Vector3f> VectorsOf(const std::vector<float>& values, float scale) {
  std::vector<Eigen::Vector3f> vectors;
  for (std::size_t i = 0; i + 2 < values.size(); i += 3)
    vectors.emplace_back(scale * InGltf({values[i], values[i + 1], values[i + 2]}));
  return vectors;
}

std::vector<MotionGap> GapsIn(const tinygltf::Value& extras) {
  std::vector<MotionGap> gaps;
  if (!extras.Has(kGaps) || !extras.Get(kGaps).IsArray()) return gaps;
  for (std::size_t i = 0; i < extras.Get(kGaps).ArrayLen(); ++i) {
    const tinygltf::Value& entry = extras.Get(kGaps).Get(static_cast<int>(i));
    if (!entry.IsObject()) continue;
    gaps.push_back({entry.Get("last_frame").GetNumberAsInt(), entry.Get("next_frame").GetNumberAsInt(),
                    entry.Get("last_time_s").GetNumberAsDouble(), entry.Get("held_until_s").GetNumberAsDouble(),
                    entry.Get("next_time_s").GetNumberAsDouble()});
  }
  return gaps;
}

// Of the keys. Throws as MeshIn.
std::vector<double> TimesIn(const tinygltf::Model& model) {
  std::vector<double> times;
  const tinygltf::Value& extras = model.meshes.at(0).extras;
  if (extras.Has(kTimes) && extras.Get(kTimes).IsArray()) {
    for (std::size_t i = 0; i < extras.Get(kTimes).ArrayLen(); ++i)
      times.push_back(extras.Get(kTimes).Get(static_cast<int>(i)).GetNumberAsDouble());
  } else if (!model.meshes.at(0).primitives.at(0).targets.empty()) {
    const auto floats = FloatsAt(model, model.animations.at(0).samplers.at(0).input).value();
    times.assign(floats.begin(), floats.end());
  }
  return times;
}

// Throws what tinygltf's and the standard library's accessors throw; nothing: not as we write it.
std::optional<GltfMesh> MeshIn(const tinygltf::Model& model) {
  const tinygltf::Mesh& entry = model.meshes.at(0);
  const tinygltf::Primitive& primitive = entry.primitives.at(0);
  const auto positions = FloatsAt(model, primitive.attributes.at("POSITION"));
  const auto normals = FloatsAt(model, primitive.attributes.at("NORMAL"));
  auto sigmas = FloatsAt(model, primitive.attributes.at(kSigma));
  const auto indices = ValuesAt<std::int32_t>(model, primitive.indices, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
  if (!positions || !normals || !sigmas || !indices || sigmas->size() * 3 != positions->size() ||
      normals->size() != positions->size())
    return std::nullopt;
  GltfMesh result;
  Mesh& mesh = result.mesh;
  mesh.vertices = VectorsOf(*positions, 1.0F / kMetersPerUnit);
  mesh.normals = VectorsOf(*normals, 1.0F);
  mesh.sigmas = *std::move(sigmas);
  for (std::size_t i = 0; i + 2 < indices->size(); i += 3) {
    mesh.triangles.push_back({(*indices)[i], (*indices)[i + 1], (*indices)[i + 2]});
    for (const std::int32_t v : mesh.triangles.back())
      if (v < 0 || static_cast<std::size_t>(v) >= mesh.vertices.size()) return std::nullopt;
  }
  if (primitive.attributes.contains("TEXCOORD_0")) {
    const auto uvs = FloatsAt(model, primitive.attributes.at("TEXCOORD_0"));
    if (!uvs || uvs->size() != 2 * mesh.vertices.size()) return std::nullopt;
    const auto uv = [&](std::int32_t v) { return Eigen::Vector2f(uvs->data() + 2 * static_cast<std::size_t>(v)); };
    for (const auto& t : mesh.triangles) mesh.texture_uvs.push_back({uv(t[0]), uv(t[1]), uv(t[2])});
    const auto& view = model.bufferViews.at(static_cast<std::size_t>(model.images.at(0).bufferView));
    const std::size_t size = model.buffers.at(0).data.size();
    if (view.byteOffset > size || view.byteLength > size - view.byteOffset) return std::nullopt;
    result.texture_jpeg.assign(reinterpret_cast<const char*>(model.buffers.at(0).data.data()) + view.byteOffset,
                               view.byteLength);
  }
  if (!entry.extras.IsObject() || !entry.extras.Has(kSubmap) || !entry.extras.Has(kFrames)) return std::nullopt;
  result.submap = entry.extras.Get(kSubmap).GetNumberAsInt();
  if (entry.extras.Has(kSigmaUnit))
    for (float& sigma : mesh.sigmas) sigma /= kMetersPerUnit;
  const tinygltf::Value& frames = entry.extras.Get(kFrames);
  if (!frames.IsArray() || frames.ArrayLen() != primitive.targets.size()) return std::nullopt;
  result.gaps = GapsIn(entry.extras);
  const std::vector<double> times = TimesIn(model);
  for (std::size_t k = 0; k < primitive.targets.size(); ++k) {
    const auto moved = FloatsAt(model, primitive.targets[k].at("POSITION"));
    if (!moved || moved->size() != positions->size()) return std::nullopt;
    MeshKey key{frames.Get(static_cast<int>(k)).GetNumberAsInt(), times.at(k),
                VectorsOf(*moved, 1.0F / kMetersPerUnit)};
    for (std::size_t v = 0; v < key.positions.size(); ++v) key.positions[v] += mesh.vertices[v];
    result.keys.push_back(std::move(key));
  }
  return result;
}

}  // namespace
}  // namespace gltf

Result<GltfMesh> ReadGlb(const std::string& path) {
  const auto bytes = ReadFile(path);
  if (!bytes.ok()) return bytes.status();
  const Status unreadable(ErrorCode::kUnreadable,
                          Quoted(path) + " is not a mesh that pliant surface wrote, or is damaged");
  tinygltf::TinyGLTF reader;
  tinygltf::Model model;
  std::string error;
  std::string warning;
  try {
    if (!reader.LoadBinaryFromMemory(&model, &error, &warning, reinterpret_cast<const unsigned char*>(bytes->data()),
                                     static_cast<unsigned int>(bytes->size())) ||
        !model.asset.generator.starts_with(gltf::kGenerator))
      return unreadable;
    auto mesh = gltf::MeshIn(model);
    if (mesh) return *std::move(mesh);
  } catch (const std::exception&) {  // what is not there
  }
  return unreadable;
}

}  // namespace pliant
