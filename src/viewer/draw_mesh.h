// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The mesh of the tissue in a scene: hidden parts are left out, and what is in front is lit from the eye.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pliant/viewer/figure.h"
#include "pliant/viewer/view.h"
#include "viewer/draw_legend.h"
#include "viewer/drawing.h"
#include "viewer/mesh_values.h"
#include "viewer/orbit.h"

namespace pliant {

// A mesh from a viewpoint.
struct MeshPicture {
  cv::Mat bgra;      // CV_8UC4, multiplied with its opacity
  cv::Mat depth;     // CV_32FC1, along the view; 0: no mesh
  double scale = 1;  // pixels of these by pixels of the panel

  // Whether what is there in the panel (x, y and its distance along the view) lies behind the mesh.
  bool Hides(const Eigen::Vector3d& seen) const;
};

// Whether there is a mesh that can be colored so: fails with kInvalidArgument where the view has no mesh (its own
// colors need none), and with kInsufficient where the true surface is not known, for kError.
Status CheckSurfaceColor(const View& view, SurfaceColor color);

// What is needed to draw the meshes of a view in any of its frames. `view` must outlive it.
class MeshPainter {
 public:
  MeshPainter(const View& view, SurfaceColor color);

  // Whether the frame has a pose, and the run a mesh of the frame's submap that is known in it.
  bool Has(std::size_t run, int frame_idx) const { return Find(run, frame_idx) != nullptr; }

  // Nothing where the run has no mesh in the frame.
  std::optional<MeshPicture> Paint(std::size_t run, int frame_idx, const Orbit& orbit, const Panel& panel) const;

  // Nothing where there is no mesh, or it has its own colors.
  const std::optional<ColorScale>& scale() const { return scale_; }

 private:
  struct Prepared {
    std::vector<cv::Mat> texture;  // CV_8UC3, each half as large as the one before; empty: none
    std::vector<Triangle> seamless;
  };

  // Null where there is none.
  const ViewedMesh* Find(std::size_t run, int frame_idx) const;

  const View& view_;
  SurfaceColor color_;
  ValueRange range_;
  std::optional<ColorScale> scale_;
  std::vector<std::vector<Prepared>> prepared_;  // of every run's meshes
};

}  // namespace pliant
