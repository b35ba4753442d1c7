// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Where the vertices of a mesh are in an image, and which of them are hidden.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pliant/camera/camera.h"
#include "pliant/surface/mesh_geometry.h"
#include "pliant/surface/mesh_raster.h"

namespace pliant {

// A point's depths belong to one surface where they differ by no more than this many standard deviations of its
// distances (`sigma` and `other_sigma`, in the unit of `in_cam`; the result is along the optical axis).
inline constexpr double kSameSurface = 3.0;
double DepthTolerance(const Eigen::Vector3d& in_cam, double sigma, double other_sigma);

struct PlacedMesh {
  std::vector<Eigen::Vector3d> in_cam;
  std::vector<std::optional<Eigen::Vector2d>> pixels;
  std::vector<double> depths;  // z along the optical axis, in the unit of `in_cam`
  MeshRaster raster;
  double step_px = 1;  // between its nodes

  // Before the camera and in its image.
  bool IsInImage(const Camera& camera, std::size_t vertex) const;
  // Whether another part of the mesh is before a vertex, which is in the image, by more than `tolerance` (of its
  // depth): by the plane of the triangle that is nearest at the node beside it. `triangles`: those of the raster.
  bool IsHidden(std::span<const Triangle> triangles, std::size_t vertex, double tolerance) const;
};

// `in_cam`: the vertices in the camera's frame. `hides`, one entry a vertex or empty (all): whether triangles with it
// may hide others. The raster has a node at every `step_px` pixels.
PlacedMesh PlaceMesh(const Camera& camera, std::vector<Eigen::Vector3d> in_cam, std::span<const Triangle> triangles,
                     const std::vector<bool>& hides, double step_px);

}  // namespace pliant
