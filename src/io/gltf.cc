// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/gltf.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <sstream>
#include <tuple>
#include <utility>

#include <tiny_gltf.h>

#include "pliant/base/files.h"
#include "pliant/base/text.h"
#include "pliant/base/version.h"

namespace pliant {
namespace {

constexpr float kMetersPerUnit = 0.001F;
// The camera's view begins and ends at so many times the median distance of the vertices from where it begins.
constexpr float kNear = 0.02F;
constexpr float kFar = 200.0F;
constexpr double kWidestViewDeg = 150.0;  // to both sides; a pinhole's view ends before 180
constexpr const char* kGenerator = "Pliant ";
constexpr const char* kUnlit = "KHR_materials_unlit";
constexpr const char* kSigma = "_SIGMA";          // an attribute of our own: standard deviation of the distance
constexpr const char* kFrames = "frames";         // extras: of the keys
constexpr const char* kSigmaUnit = "sigma_unit";  // extras; earlier versions, which had map units, lack it
constexpr const char* kMeters = "m";
constexpr const char* kSubmap = "submap";
constexpr const char* kTimes = "times_s";  // extras: of the keys; earlier versions have those of the animation alone
constexpr const char* kGaps = "gaps";      // extras; earlier versions lack them

// From x right, y down, z forward to glTF's x right, y up, z backward.
Eigen::Vector3f InGltf(const Eigen::Vector3f& v) { return {v.x(), -v.y(), -v.z()}; }

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

// A glTF model whose data are all in one buffer.
class ModelBuilder {
 public:
  ModelBuilder() {
    model_.asset.version = "2.0";
    model_.asset.generator = std::string(kGenerator) + kVersion;
    model_.buffers.emplace_back();
  }

  tinygltf::Model& model() { return model_; }

  int AddView(std::span<const unsigned char> bytes, int target) {
    std::vector<unsigned char>& data = model_.buffers[0].data;
    while (data.size() % 4 != 0) data.push_back(0);
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = data.size();
    view.byteLength = bytes.size();
    view.target = target;
    data.insert(data.end(), bytes.begin(), bytes.end());
    model_.bufferViews.push_back(view);
    return static_cast<int>(model_.bufferViews.size()) - 1;
  }

  // `target`: what the values are of; 0: of an animation.
  int AddFloats(const std::vector<float>& values, int type, bool with_bounds, int target) {
    tinygltf::Accessor accessor;
    accessor.bufferView = AddView(Bytes(values), target);
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
    accessor.type = type;
    const auto components = static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<uint32_t>(type)));
    accessor.count = values.size() / components;
    if (with_bounds) {
      accessor.minValues.assign(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(components));
      accessor.maxValues = accessor.minValues;
      for (std::size_t i = 0; i < values.size(); ++i) {
        double& least = accessor.minValues[i % components];
        double& largest = accessor.maxValues[i % components];
        least = std::min(least, static_cast<double>(values[i]));
        largest = std::max(largest, static_cast<double>(values[i]));
      }
    }
    return Add(accessor);
  }

  int AddIndices(const std::vector<std::uint32_t>& indices) {
    tinygltf::Accessor accessor;
    accessor.bufferView = AddView(Bytes(indices), TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    accessor.type = TINYGLTF_TYPE_SCALAR;
    accessor.count = indices.size();
    return Add(accessor);
  }

 private:
  template <class T>
  static std::span<const unsigned char> Bytes(const std::vector<T>& values) {
    return {reinterpret_cast<const unsigned char*>(values.data()), values.size() * sizeof(T)};
  }

  int Add(const tinygltf::Accessor& accessor) {
    model_.accessors.push_back(accessor);
    return static_cast<int>(model_.accessors.size()) - 1;
  }

  tinygltf::Model model_;
};

void Append(const Eigen::Vector3f& vector, std::vector<float>* values) {
  values->insert(values->end(), vector.data(), vector.data() + 3);
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

// Of the recording, where the animation begins.
double StartOf(const MeshAnimation& animation) {
  double start_s = 0.0;
  if (!animation.path.empty()) start_s = animation.path.front().time_s;
  if (!animation.keys.empty()) start_s = std::min(start_s, animation.keys.front().time_s);
  return start_s;
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

// Of the vertices from the first camera, m.
float MedianDistance(const MeshAnimation& animation) {
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  if (!animation.path.empty()) center = animation.path.front().world_from_cam.translation.cast<float>();
  std::vector<float> distances;
  for (const Eigen::Vector3f& vertex : animation.mesh.vertices)
    distances.push_back(kMetersPerUnit * (vertex - center).norm());
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::ranges::nth_element(distances, middle);
  return std::max(*middle, 1e-6F);
}

// Where a pixel cannot be unprojected, as in the black corners of an endoscope's image: of the nearest one towards the
// image's center that can.
std::optional<Eigen::Vector3d> RayTowards(const Camera& camera, const Eigen::Vector2d& pixel) {
  constexpr int kSteps = 20;
  const Eigen::Vector2d center(0.5 * (camera.width() - 1), 0.5 * (camera.height() - 1));
  for (int step = kSteps; step > 0; --step)
    if (auto ray = camera.Unproject(center + static_cast<double>(step) / kSteps * (pixel - center))) return ray;
  return std::nullopt;
}

// Half the width and height, at the distance 1, of the smallest view around the optical axis that shows the whole
// image, as far as a pinhole can.
Eigen::Vector2d HalfViewOf(const Camera& camera) {
  constexpr int kSteps = 32;  // along each side
  constexpr double kLeast = 1e-6;
  const double largest = std::tan(0.5 * kWidestViewDeg * std::numbers::pi / 180.0);
  const double right = camera.width() - 0.5;
  const double bottom = camera.height() - 0.5;
  Eigen::Vector2d half = Eigen::Vector2d::Constant(kLeast);
  for (int step = 0; step <= kSteps; ++step) {
    const double x = std::lerp(-0.5, right, static_cast<double>(step) / kSteps);
    const double y = std::lerp(-0.5, bottom, static_cast<double>(step) / kSteps);
    for (const Eigen::Vector2d& pixel :
         {Eigen::Vector2d(x, -0.5), Eigen::Vector2d(x, bottom), Eigen::Vector2d(-0.5, y), Eigen::Vector2d(right, y)})
      if (const auto ray = RayTowards(camera, pixel))
        half = half.cwiseMax((ray->head<2>().cwiseAbs() / std::max(ray->z(), kLeast)).cwiseMin(largest));
  }
  return half;
}

tinygltf::Value IntrinsicsOf(const Camera& camera) {
  tinygltf::Value::Array params;
  for (const double param : camera.params()) params.emplace_back(param);
  tinygltf::Value::Object intrinsics;
  intrinsics.emplace("model", tinygltf::Value(std::string(camera.model_name())));
  intrinsics.emplace("width", tinygltf::Value(camera.width()));
  intrinsics.emplace("height", tinygltf::Value(camera.height()));
  intrinsics.emplace("params", tinygltf::Value(std::move(params)));
  return tinygltf::Value(std::move(intrinsics));
}

void AddCamera(const MeshAnimation& animation, ModelBuilder* builder) {
  tinygltf::Camera camera;
  camera.type = "perspective";
  const Eigen::Vector2d half = HalfViewOf(animation.camera);
  camera.perspective.yfov = 2.0 * std::atan(half.y());
  camera.perspective.aspectRatio = half.x() / half.y();
  camera.extras = IntrinsicsOf(animation.camera);
  const float distance = MedianDistance(animation);
  camera.perspective.znear = static_cast<double>(kNear * distance);
  camera.perspective.zfar = static_cast<double>(kFar * distance);
  builder->model().cameras.push_back(camera);
  tinygltf::Node node;
  node.name = "camera";
  node.camera = 0;
  builder->model().nodes.push_back(node);
}

constexpr int kSurfaceNode = 0;
constexpr int kCameraNode = 1;

// What a node does over time.
void AddChannel(int node, const char* what, int times, int values, tinygltf::Animation* animation) {
  tinygltf::AnimationSampler sampler;
  sampler.input = times;
  sampler.output = values;
  sampler.interpolation = "LINEAR";
  animation->samplers.push_back(sampler);
  tinygltf::AnimationChannel channel;
  channel.sampler = static_cast<int>(animation->samplers.size()) - 1;
  channel.target_node = node;
  channel.target_path = what;
  animation->channels.push_back(channel);
}

// A key at a time of the animation.
struct KeyAtTime {
  float time_s = 0;
  std::size_t key = 0;
};

// Each key at its time. Across a gap the one before it is held, and the one behind it is there at once.
template <class Keys>
std::vector<KeyAtTime> KeysInTime(const Keys& keys, const MeshAnimation& animation) {
  const auto at = [start_s = StartOf(animation)](double time_s) { return static_cast<float>(time_s - start_s); };
  std::vector<KeyAtTime> result;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    result.push_back({at(keys[k].time_s), k});
    if (k + 1 == keys.size()) break;
    const auto gap = std::ranges::find_if(animation.gaps, [&](const MotionGap& candidate) {
      return keys[k].time_s <= candidate.last_time_s && candidate.next_time_s <= keys[k + 1].time_s;
    });
    if (gap == animation.gaps.end()) continue;
    // Times must increase, also when rounded to a float.
    const float held_until = at(gap->held_until_s);
    const float next = at(gap->next_time_s);
    if (result.back().time_s < held_until && held_until < next) result.push_back({held_until, k});
    if (result.back().time_s < next && next < at(keys[k + 1].time_s)) result.push_back({next, k + 1});
  }
  return result;
}

int AddTimes(const std::vector<KeyAtTime>& keys, ModelBuilder* builder) {
  std::vector<float> times;
  for (const KeyAtTime& key : keys) times.push_back(key.time_s);
  return builder->AddFloats(times, TINYGLTF_TYPE_SCALAR, true, 0);
}

// The rotation of a camera that looks along its -z with y up, as glTF's does, in glTF's world.
Eigen::Quaternionf RotationInGltf(const Rigid3& world_from_cam) {
  const Eigen::Vector3d turn(1.0, -1.0, -1.0);
  const Eigen::Matrix3d rotation = turn.asDiagonal() * world_from_cam.RotationMatrix() * turn.asDiagonal();
  return Eigen::Quaterniond(rotation).normalized().cast<float>();
}

void AddMeshMotion(const MeshAnimation& input, ModelBuilder* builder, tinygltf::Animation* animation) {
  const std::vector<KeyAtTime> keys = KeysInTime(input.keys, input);
  const std::size_t count = input.keys.size();
  std::vector<float> weights(keys.size() * count, 0.0F);
  for (std::size_t row = 0; row < keys.size(); ++row) weights[row * count + keys[row].key] = 1.0F;
  AddChannel(kSurfaceNode, "weights", AddTimes(keys, builder),
             builder->AddFloats(weights, TINYGLTF_TYPE_SCALAR, false, 0), animation);
}

void AddCameraMotion(const MeshAnimation& input, ModelBuilder* builder, tinygltf::Animation* animation) {
  const std::vector<KeyAtTime> keys = KeysInTime(input.path, input);
  std::vector<float> translations;
  std::vector<float> rotations;
  Eigen::Quaternionf last = Eigen::Quaternionf::Identity();
  for (const KeyAtTime& key : keys) {
    const Rigid3& world_from_cam = input.path[key.key].world_from_cam;
    Append(InGltf(kMetersPerUnit * world_from_cam.translation.cast<float>()), &translations);
    Eigen::Quaternionf rotation = RotationInGltf(world_from_cam);
    if (rotation.dot(last) < 0.0F) rotation.coeffs() *= -1.0F;  // interpolated the short way
    rotations.insert(rotations.end(), rotation.coeffs().data(), rotation.coeffs().data() + 4);
    last = rotation;
  }
  const int times = AddTimes(keys, builder);
  AddChannel(kCameraNode, "translation", times, builder->AddFloats(translations, TINYGLTF_TYPE_VEC3, false, 0),
             animation);
  AddChannel(kCameraNode, "rotation", times, builder->AddFloats(rotations, TINYGLTF_TYPE_VEC4, false, 0), animation);
}

void AddAnimation(const MeshAnimation& input, ModelBuilder* builder) {
  tinygltf::Animation animation;
  animation.name = "recording";
  if (!input.keys.empty()) AddMeshMotion(input, builder, &animation);
  if (!input.path.empty()) AddCameraMotion(input, builder, &animation);
  if (!animation.channels.empty()) builder->model().animations.push_back(animation);
}

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

Status WriteGlb(const std::string& path, const MeshAnimation& animation) {
  if (animation.mesh.triangles.empty())
    return {ErrorCode::kInsufficient, "the mesh has no triangles; " + Quoted(path) + " is not written"};
  ModelBuilder builder;
  AddMesh(animation, &builder);
  AddCamera(animation, &builder);
  AddAnimation(animation, &builder);
  tinygltf::Scene scene;
  scene.nodes = {kSurfaceNode, kCameraNode};
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
        !model.asset.generator.starts_with(kGenerator))
      return unreadable;
    auto mesh = MeshIn(model);
    if (mesh) return *std::move(mesh);
  } catch (const std::exception&) {  // what is not there
  }
  return unreadable;
}

}  // namespace pliant
