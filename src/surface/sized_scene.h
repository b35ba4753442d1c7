// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A reference image and those it is compared with, at a size.
#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/camera/camera.h"
#include "pliant/surface/dense_depth.h"
#include "surface/sparse_surface.h"
#include "surface/view_matching.h"

namespace pliant {

// The camera at a size, and the unit rays of its pixels.
struct SizedCamera {
  explicit SizedCamera(const Camera& c);

  Camera camera;
  cv::Mat rays;  // CV_32FC3; 0 where no ray projects

  cv::Size size() const { return rays.size(); }
};

// How images are compared at a size.
struct Comparison {
  int window_px = 11;
  double smoothing_px = 0;
  double noise_variance = 1;  // gray levels^2
};

// What is known of the reference and of those it is compared with, whatever the size.
struct Scene {
  const SurfaceView& reference;
  std::vector<const SurfaceView*> others;
  std::vector<SurfaceMotion> motions;  // one each
  SparseSurface surface;
  int grid_width = 0;  // of the image in whose pixels the grids count
};

struct SizedScene {
  SizedScene(const Scene& scene, const SizedCamera& sized, const Comparison& how, int threads);

  const SizedCamera& camera;
  ReferenceWindows reference;
  std::vector<MatchingView> views;
};

}  // namespace pliant
