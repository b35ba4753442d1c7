// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A mesh as a camera sees it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pliant/camera/camera.h"

namespace pliant {

struct MeshRaster {
  cv::Mat depth;     // CV_32FC1, z along the optical axis; 0: no triangle
  cv::Mat triangle;  // CV_32SC1, its index; -1: none
};

inline constexpr std::int32_t kNoTriangle = -1;

// The nearest triangle at every pixel of an image of `size` whose pixels are `step` of the camera's apart. `pixels`:
// where the vertices project in the camera's image; a triangle with one that does not is left out. `depths`: their z.
MeshRaster RasterizeMesh(std::span<const std::optional<Eigen::Vector2d>> pixels, std::span<const double> depths,
                         std::span<const std::array<std::int32_t, 3>> triangles, cv::Size size, double step);

}  // namespace pliant
