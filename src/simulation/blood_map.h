// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What is painted on the wall: the local amount of blood, as a map over the surface's chart with its reduced copies.
// Value 0 is the mean mucosa; +1 is clearly redder and darker, -1 paler. It belongs to the material: mottling is noise
// at the position at rest (so it does not stretch where the chart does), vessels are drawn on the chart.
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/simulation/options.h"
#include "simulation/surface.h"

namespace pliant::simulation {

class BloodMap {
 public:
  BloodMap(const SimulationOptions::Texture& options, int seed, const Surface& surface);

  // The value at a position of the chart, averaged over about `footprint_mm`.
  float At(float x_mm, float y_mm, float footprint_mm) const;

 private:
  float Bilinear(const cv::Mat& level, float x, float y) const;

  std::vector<cv::Mat> levels_;  // CV_16UC1, value = raw * kStep + kLowest; level i has texels of texel * 2^i
  float texels_per_mm_x_ = 1;
  float texels_per_mm_y_ = 1;
  float texel_mm_ = 1;
};

}  // namespace pliant::simulation
