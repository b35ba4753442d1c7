// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A triangle mesh with what is known of its vertices.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace pliant {

struct Mesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Eigen::Vector3f> normals;          // a vertex each, of unit length
  std::vector<std::array<std::uint8_t, 3>> rgb;  // a vertex each
  std::vector<float> sigmas;                     // a vertex each: standard deviation of the distance from the camera
  std::vector<std::int32_t> ids;                 // a vertex each: the same in every frame; empty where it has none
  std::vector<std::uint8_t> views;               // a vertex each: VertexView in a frame; empty where it is of none
  std::vector<std::array<std::int32_t, 3>> triangles;  // indices of vertices
  // A triangle each: where its corners are in a texture image, 0 to 1, from the image's upper left corner; empty where
  // there is none.
  std::vector<std::array<Eigen::Vector2f, 3>> texture_uvs;
};

}  // namespace pliant
