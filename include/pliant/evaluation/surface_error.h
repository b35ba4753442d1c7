// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How far the estimated points lie from the true surface (Gomez Rodriguez et al., IROS 2022, section IV). The truth of
// a point is the surface point on the ray of the pixel where it was observed, at a depth that a SurfaceTruth knows
// (surface_truth.h). What is left out is counted by reason. A track that slides over the surface
// has no surface error; its material error (material_error.h) shows it.
#pragma once

#include <span>

#include <Eigen/Core>

#include "pliant/camera/camera.h"
#include "pliant/evaluation/point_error.h"
#include "pliant/image/depth_lookup.h"

namespace pliant {

// Pairs the points of one frame with the truth, for ComputePointError. `points_in_cam`, `sigmas` (of their distances,
// as the run says; none: it does not), `pixels` and `truth`, the depth of the surface at each of them, have one length.
PairedFrame PairWithSurface(int frame_idx, std::span<const Eigen::Vector3d> points_in_cam,
                            std::span<const double> sigmas, std::span<const Eigen::Vector2d> pixels,
                            const Camera& camera, std::span<const DepthAtPixel> truth, double max_sigma_mm);

}  // namespace pliant
