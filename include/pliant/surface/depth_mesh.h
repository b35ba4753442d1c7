// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The surface that a dense depth shows, as a mesh.
#pragma once

#include <opencv2/core/mat.hpp>

#include "pliant/camera/camera.h"
#include "pliant/scene/mesh.h"
#include "pliant/surface/dense_depth.h"

namespace pliant {

// In the camera's frame, map units: a vertex at every `step_px`-th pixel that has a depth, triangles between neighbors
// where no contour lies between them, facing the camera. `image`: 8-bit, 1 or 3 (BGR) channels, for the colors.
Mesh MeshOfDepth(const Camera& camera, const DenseDepth& dense, const cv::Mat& image, int step_px);

}  // namespace pliant
