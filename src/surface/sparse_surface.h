// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the tracked points say of a whole image: a surface through them, and how it has moved until another image.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pliant/camera/camera.h"
#include "pliant/surface/dense_depth.h"
#include "surface/grid_field.h"

namespace pliant {

// How far a point that was held out is from a surface through the others.
struct HeldOutPoint {
  Eigen::Vector2d pixel;
  double error = 0;  // of the inverse distance, relative, unsigned
};

// (V1) Inverse distances along the rays.
struct SparseSurface {
  GridField inverse_distance;
  GridField log_relative_sigma;  // of the points' own distances
  std::vector<HeldOutPoint> held_out;
  std::vector<Eigen::Vector3d> points;  // camera frame
  double apart = 0.1;                   // what they are from each other, by their distance; median

  // How far a point of the surface is from the nearest tracked one, by what these are apart; at least 1.
  double Remoteness(const Eigen::Vector3d& in_cam) const;
};

// `camera` is that of the size at which the grid's pixels are counted. Nothing with fewer than kMinPoints.
inline constexpr std::size_t kMinPoints = 12;
std::optional<SparseSurface> FitSparseSurface(const SurfaceView& view, const Camera& camera);

// (V2) How points have moved from the one view to the other, map units, world frame: by the points that both have.
struct SurfaceMotion {
  GridField field;
  double error = 0;  // of points that were held out, by their distance from the camera; median
};
// Nothing with fewer than kMinPoints.
std::optional<SurfaceMotion> FitMotion(const SurfaceView& reference, const SurfaceView& other, const Camera& camera);

}  // namespace pliant
