// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The paths of material points: which point of the wall a pixel of a frame shows, and where that point is, and is
// seen, in every frame. The steps of `pliant truth`; a program that wants single answers asks the Simulator itself:
//   Result<Simulator> simulator = OpenSimulation(folder);
//   const auto hits = simulator->HitsAt(frame_idx, pixels);          the points that pixels show
//   const auto seen = simulator->Observe(later_frame_idx, points);   where they are in another frame
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/simulation/simulator.h"
#include "pliant/simulation/write_sequence.h"

namespace pliant {

// A position in an image; (0, 0) is the center of the first pixel.
struct FramePixel {
  int frame_idx = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

struct MaterialPath {
  FramePixel start;                               // what was asked for
  std::optional<MaterialPoint> point;             // nothing where the pixel's ray meets no wall
  std::vector<MaterialObservation> observations;  // one a frame, from frame 0; empty where there is no point
};

// Every step_px-th pixel each way, half a step from the border, row by row.
std::vector<FramePixel> PixelGrid(const Camera& camera, int frame_idx, int step_px);

// Reads a CSV file whose header names the columns frame, u_px and v_px; others are passed over, so that an
// observations.csv serves. Fails with kNotFound, or with kUnreadable and the line.
Result<std::vector<FramePixel>> ReadFramePixels(const std::filesystem::path& path);

// One path a start, in their order. Fails with kInvalidArgument for a frame that the simulation does not have and for a
// pixel outside the image (the sentence names both and the start, from 1), with kInterrupted when `progress` asked to
// stop.
Result<std::vector<MaterialPath>> FollowMaterial(Simulator& simulator, std::span<const FramePixel> starts,
                                                 const SimulationProgress& progress = {});

// Writes one row a point and frame: point,frame,u_px,v_px,x,y,z,depth_mm,visibility. `point` is the start's position in
// the list, from 0, and has no rows where its pixel showed nothing; u_px and v_px are empty where the point does not
// project; x, y, z in the world, mm; visibility is visible, occluded or outside. Fails with kUnwritable.
Status WriteMaterialPaths(const std::filesystem::path& path, std::span<const MaterialPath> paths);

}  // namespace pliant
