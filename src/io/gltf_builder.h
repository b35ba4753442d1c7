// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A glTF model as it is built up.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <tiny_gltf.h>

#include "io/gltf_layout.h"
#include "pliant/io/gltf.h"

namespace pliant::gltf {

// A model whose data are all in one buffer.
class ModelBuilder {
 public:
  ModelBuilder();

  tinygltf::Model& model() { return model_; }

  // Bytes as a view of the buffer; `target`: what they are for; 0: an image or an animation.
  int AddView(std::span<const unsigned char> bytes, int target);
  // An accessor of `type`.
  int AddFloats(const std::vector<float>& values, int type, bool with_bounds, int target);
  int AddIndices(const std::vector<std::uint32_t>& indices);

 private:
  int Add(const tinygltf::Accessor& accessor);

  tinygltf::Model model_;
};

inline void Append(const Eigen::Vector3f& vector, std::vector<float>* values) {
  values->insert(values->end(), vector.data(), vector.data() + 3);
}

// Of the recording, s, where the animation begins.
double StartOf(const MeshAnimation& animation);

// A camera that shows the whole image, as a node of the model.
void AddCamera(const MeshAnimation& animation, ModelBuilder* builder);

// How the mesh and the camera move, which are nodes of the model.
inline constexpr int kSurfaceNode = 0;
inline constexpr int kCameraNode = 1;
void AddAnimation(const MeshAnimation& animation, ModelBuilder* builder);

}  // namespace pliant::gltf
