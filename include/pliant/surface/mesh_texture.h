// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// One texture image for a mesh, from images that show it.
#pragma once

#include <span>

#include <opencv2/core/mat.hpp>

#include "pliant/camera/camera.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/scene/mesh.h"
#include "pliant/surface/tracked_mesh.h"

namespace pliant {

// An image from which a texture may be taken, and where the mesh is in it.
struct TextureView {
  cv::Mat image;  // 8-bit, 1 or 3 (BGR) channels, the camera's size
  cv::Mat valid;  // CV_8UC1, 0 = not the surface (a highlight, an instrument)
  Rigid3 cam_from_world;
  MeshInFrame mesh;
  double sharpness = 1;  // of the image, in any unit
};

// (V13) Sets `mesh->texture_uvs`. The mesh has colors, and the views its vertices. A triangle is taken from the image
// that shows it best: large, sharp and valid; from as few images as that allows, their brightness made equal where they
// meet. One that no image shows has the mean color of its vertices. The texture is BGR, at most `max_size` px wide and
// high.
cv::Mat MakeTexture(const Camera& camera, std::span<const TextureView> views, int max_size, Mesh* mesh);

}  // namespace pliant
