// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cstddef>
#include <string>

#include <Eigen/Geometry>

#include "io/gltf_builder.h"

namespace pliant::gltf {
namespace {

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
}  // namespace

void AddAnimation(const MeshAnimation& input, ModelBuilder* builder) {
  tinygltf::Animation animation;
  animation.name = "recording";
  if (!input.keys.empty()) AddMeshMotion(input, builder, &animation);
  if (!input.path.empty()) AddCameraMotion(input, builder, &animation);
  if (!animation.channels.empty()) builder->model().animations.push_back(animation);
}

}  // namespace pliant::gltf
