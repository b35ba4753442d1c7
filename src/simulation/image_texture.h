// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The picture that a mesh brought with it, as the wall's albedo, with its reduced copies.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "simulation/surface.h"

namespace pliant::simulation {

class ImageTexture {
 public:
  // Of a surface with an image.
  explicit ImageTexture(const Surface& surface);

  // Blue, green, red, linear (gamma 2.2 undone), at a position of the chart, averaged over about `footprint_mm`. The
  // picture repeats beyond its edges.
  Eigen::Vector3f At(const Eigen::Vector2f& chart, float footprint_mm) const;

 private:
  std::vector<cv::Mat> levels_;  // CV_16UC3, 65535: all light; each half as large as the one before
  float texel_mm_ = 1;           // of the first level, on the average over the surface
};

}  // namespace pliant::simulation
