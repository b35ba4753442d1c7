// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <tiny_gltf.h>

#include "io/gltf_builder.h"
#include "io/gltf_layout.h"
#include "pliant/base/files.h"
#include "pliant/base/text.h"
#include "pliant/io/gltf.h"

namespace pliant {
namespace gltf {
namespace {

constexpr const char* kUnlit = "KHR_materials_unlit";

// A vertex as glTF has it: one for each place of the texture at which the mesh's vertex is used.
struct Corner {
  std::int32_t vertex = 0;
  Eigen::Vector2f uv = Eigen::Vector2f::Zero();
};

struct Corners {
  std::vector<Corner> corners;
  std::vector<std::uint32_t> indices;  // three a triangle
};

Corners SplitAtSeams(const Mesh& mesh) {
  Corners result;
  std::map<std::tuple<std::int32_t, float, float>, std::uint32_t> index_of;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t v = mesh.triangles[t][k];
      const Eigen::Vector2f uv =
          mesh.texture_uvs.empty() ? Eigen::Vector2f(Eigen::Vector2f::Zero()) : mesh.texture_uvs[t][k];
      const auto next = static_cast<std::uint32_t>(result.corners.size());
      const auto [entry, is_new] = index_of.try_emplace({v, uv.x(), uv.y()}, next);
      if (is_new) result.corners.push_back({v, uv});
      result.indices.push_back(entry->second);
    }
  return result;
}

// `of` gives a vertex's vector in the mesh's frame.
template <class Function>
std::vector<float> OfCorners(const Corners& corners, const Function& of) {
  std::vector<float> values;
  for (const Corner& corner : corners.corners) Append(InGltf(of(static_cast<std::size_t>(corner.vertex))), &values);
  return values;
}

std::vector<float> Colors(const Corners& corners, const Mesh& mesh) {
  // COLOR_0 is linear, images are sRGB.
  std::vector<float> values;
  for (const Corner& corner : corners.corners)
    for (const std::uint8_t channel : mesh.rgb[static_cast<std::size_t>(corner.vertex)])
      values.push_back(std::pow(static_cast<float>(channel) / 255.0F, 2.2F));
  return values;
}

std::vector<float> TextureUvs(const Corners& corners) {
  std::vector<float> values;
  for (const Corner& corner : corners.corners) values.insert(values.end(), corner.uv.data(), corner.uv.data() + 2);
  return values;
}

int AddMaterial(std::string_view texture_jpeg, ModelBuilder* builder) {
  tinygltf::Model& model = builder->model();
  tinygltf::Material material;
  material.name = "tissue";
  material.doubleSided = true;
  material.pbrMetallicRoughness.metallicFactor = 0.0;
  material.pbrMetallicRoughness.roughnessFactor = 1.0;
  if (!texture_jpeg.empty()) {
    tinygltf::Image image;
    image.mimeType = "image/jpeg";
    image.bufferView =
        builder->AddView({reinterpret_cast<const unsigned char*>(texture_jpeg.data()), texture_jpeg.size()}, 0);
    model.images.push_back(image);
    model.samplers.emplace_back();
    tinygltf::Texture entry;
    entry.source = 0;
    entry.sampler = 0;
    model.textures.push_back(entry);
    material.pbrMetallicRoughness.baseColorTexture.index = 0;
  }
  // The texture has the light of the endoscope in it already.
  material.extensions.emplace(kUnlit, tinygltf::Value(tinygltf::Value::Object()));
  model.extensionsUsed.emplace_back(kUnlit);
  model.materials.push_back(material);
  return 0;
}
tinygltf::Value GapsOf(const MeshAnimation& animation) {
  const double start_s = StartOf(animation);
  tinygltf::Value::Array gaps;
  for (const MotionGap& gap : animation.gaps) {
    tinygltf::Value::Object entry;
    entry.emplace("last_frame", tinygltf::Value(gap.last_frame_idx));
    entry.emplace("next_frame", tinygltf::Value(gap.next_frame_idx));
    entry.emplace("last_time_s", tinygltf::Value(gap.last_time_s - start_s));
    entry.emplace("held_until_s", tinygltf::Value(gap.held_until_s - start_s));
    entry.emplace("next_time_s", tinygltf::Value(gap.next_time_s - start_s));
    gaps.emplace_back(std::move(entry));
  }
  return tinygltf::Value(std::move(gaps));
}

tinygltf::Value ExtrasOf(const MeshAnimation& animation) {
  tinygltf::Value::Array frames;
  tinygltf::Value::Array times;
  for (const MeshKey& key : animation.keys) {
    frames.emplace_back(key.frame_idx);
    times.emplace_back(key.time_s - StartOf(animation));
  }
  tinygltf::Value::Object extras;
  extras.emplace(kFrames, tinygltf::Value(std::move(frames)));
  extras.emplace(kTimes, tinygltf::Value(std::move(times)));
  if (!animation.gaps.empty()) extras.emplace(kGaps, GapsOf(animation));
  extras.emplace(kSubmap, tinygltf::Value(animation.submap));
  extras.emplace(kSigmaUnit, tinygltf::Value(std::string(kMeters)));
  return tinygltf::Value(std::move(extras));
}

void AddMesh(const MeshAnimation& animation, ModelBuilder* builder) {
  const Mesh& mesh = animation.mesh;
  const Corners corners = SplitAtSeams(mesh);
  const auto at = [](const std::vector<Eigen::Vector3f>& vectors) {
    return [&vectors](std::size_t v) { return vectors[v]; };
  };
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.material = AddMaterial(animation.texture_jpeg, builder);
  primitive.indices = builder->AddIndices(corners.indices);
  const int target = TINYGLTF_TARGET_ARRAY_BUFFER;
  primitive.attributes["POSITION"] = builder->AddFloats(
      OfCorners(corners, [&](std::size_t v) { return Eigen::Vector3f(kMetersPerUnit * mesh.vertices[v]); }),
      TINYGLTF_TYPE_VEC3, true, target);
  primitive.attributes["NORMAL"] =
      builder->AddFloats(OfCorners(corners, at(mesh.normals)), TINYGLTF_TYPE_VEC3, false, target);
  if (animation.texture_jpeg.empty())
    primitive.attributes["COLOR_0"] = builder->AddFloats(Colors(corners, mesh), TINYGLTF_TYPE_VEC3, false, target);
  else
    primitive.attributes["TEXCOORD_0"] = builder->AddFloats(TextureUvs(corners), TINYGLTF_TYPE_VEC2, false, target);
  std::vector<float> sigmas;
  for (const Corner& corner : corners.corners)
    sigmas.push_back(kMetersPerUnit * mesh.sigmas[static_cast<std::size_t>(corner.vertex)]);
  primitive.attributes[kSigma] = builder->AddFloats(sigmas, TINYGLTF_TYPE_SCALAR, false, target);
  for (const MeshKey& key : animation.keys) {
    const auto moved = [&](std::size_t v) {
      return Eigen::Vector3f(kMetersPerUnit * (key.positions[v] - mesh.vertices[v]));
    };
    primitive.targets.push_back(
        {{"POSITION", builder->AddFloats(OfCorners(corners, moved), TINYGLTF_TYPE_VEC3, true, target)}});
  }
  tinygltf::Mesh entry;
  entry.name = "surface";
  entry.primitives.push_back(primitive);
  entry.extras = ExtrasOf(animation);
  entry.weights.assign(animation.keys.size(), 0.0);
  if (!entry.weights.empty()) entry.weights[0] = 1.0;
  builder->model().meshes.push_back(entry);
  tinygltf::Node node;
  node.name = "surface";
  node.mesh = 0;
  builder->model().nodes.push_back(node);
}

}  // namespace
}  // namespace gltf

Status WriteGlb(const std::string& path, const MeshAnimation& animation) {
  if (animation.mesh.triangles.empty())
    return {ErrorCode::kInsufficient, "the mesh has no triangles; " + Quoted(path) + " is not written"};
  gltf::ModelBuilder builder;
  gltf::AddMesh(animation, &builder);
  gltf::AddCamera(animation, &builder);
  gltf::AddAnimation(animation, &builder);
  tinygltf::Scene scene;
  scene.nodes = {gltf::kSurfaceNode, gltf::kCameraNode};
  builder.model().scenes.push_back(scene);
  builder.model().defaultScene = 0;
  // The format counts its bytes in 32 bits; a description in JSON comes before the numbers.
  constexpr std::size_t kMostBytes = std::numeric_limits<std::uint32_t>::max() - (std::size_t{1} << 26);
  std::size_t bytes = 0;
  for (const tinygltf::Buffer& buffer : builder.model().buffers) bytes += buffer.data.size();
  std::ostringstream stream;
  tinygltf::TinyGLTF writer;
  if (bytes > kMostBytes || !writer.WriteGltfSceneToStream(&builder.model(), stream, false, true))
    return {ErrorCode::kUnwritable,
            "cannot write " + Quoted(path) +
                ": the model is too large for a .glb file; lower Surface.animation_keys or Surface.mesh_columns"};
  return WriteFileAtomically(path, std::move(stream).str());
}

}  // namespace pliant
