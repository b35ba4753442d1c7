// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The rays of a camera, computed once: for every pixel a fixed pattern of samples over its area, and its center.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "pliant/camera/camera.h"

namespace pliant::simulation {

class RayTable {
 public:
  // `samples` is made a square number, from below.
  RayTable(const Camera& camera, int samples);

  int samples_per_side() const { return samples_per_side_; }
  int rays_per_pixel() const { return samples_per_side_ * samples_per_side_ + 1; }
  // Unit rays of a row in the camera frame, pixel after pixel, the center last; zero where there is no ray.
  std::span<const Eigen::Vector3f> Row(int y) const;
  Eigen::Vector3d Center(int x, int y) const;

 private:
  int samples_per_side_;
  int width_;
  std::vector<Eigen::Vector3f> rays_;
};

}  // namespace pliant::simulation
