// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/gltf_builder.h"

#include <algorithm>
#include <cstddef>
#include <string>

#include "pliant/base/version.h"

namespace pliant::gltf {
namespace {

template <class T>
std::span<const unsigned char> BytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const unsigned char*>(values.data()), values.size() * sizeof(T)};
}

}  // namespace

ModelBuilder::ModelBuilder() {
  model_.asset.version = "2.0";
  model_.asset.generator = std::string(kGenerator) + kVersion;
  model_.buffers.emplace_back();
}

int ModelBuilder::AddView(std::span<const unsigned char> bytes, int target) {
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

int ModelBuilder::AddFloats(const std::vector<float>& values, int type, bool with_bounds, int target) {
  tinygltf::Accessor accessor;
  accessor.bufferView = AddView(BytesOf(values), target);
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

int ModelBuilder::AddIndices(const std::vector<std::uint32_t>& indices) {
  tinygltf::Accessor accessor;
  accessor.bufferView = AddView(BytesOf(indices), TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
  accessor.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  accessor.type = TINYGLTF_TYPE_SCALAR;
  accessor.count = indices.size();
  return Add(accessor);
}

int ModelBuilder::Add(const tinygltf::Accessor& accessor) {
  model_.accessors.push_back(accessor);
  return static_cast<int>(model_.accessors.size()) - 1;
}

double StartOf(const MeshAnimation& animation) {
  double start_s = 0.0;
  if (!animation.path.empty()) start_s = animation.path.front().time_s;
  if (!animation.keys.empty()) start_s = std::min(start_s, animation.keys.front().time_s);
  return start_s;
}

}  // namespace pliant::gltf
