// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The scene of a frame: the map, the trails of its points, the camera's path, and the truth.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <set>
#include <vector>

#include <Eigen/Core>

#include "pliant/viewer/figure.h"
#include "pliant/viewer/view.h"
#include "viewer/draw_legend.h"
#include "viewer/draw_mesh.h"
#include "viewer/drawing.h"
#include "viewer/orbit.h"

namespace pliant {

// The eye that sees all of a run, its cameras included, and the camera as it is drawn there. Of a run with meshes it
// sees these, which reach farther than the points, of which there are more.
struct Viewpoint {
  Orbit orbit;
  std::optional<std::array<Eigen::Vector3d, 4>> frustum;  // FrustumOf
};
Viewpoint ViewpointOf(const View& view, const ViewedRun& run, const FigureOptions& options, double width_px,
                      double height_px);

// Draws the runs of a view in any of their frames, all panels of one size. View and options must outlive it.
class SceneDrawer {
 public:
  SceneDrawer(const View& view, const FigureOptions& options, double width_px, double height_px);

  // A frame without a pose says why. Where a run that has meshes has none in the frame, that is said, and its
  // undeformed map is drawn, as that of a run without meshes.
  void Draw(cairo_t* drawing, const Panel& panel, std::size_t run, int frame_idx) const;

  // What the colors of these frames mean.
  LegendContent Legend(const std::set<int>& frames_idx) const;

 private:
  const View& view_;
  const FigureOptions& options_;
  MeshPainter meshes_;
  std::vector<Viewpoint> viewpoints_;  // one a run
};

}  // namespace pliant
