// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How far the estimated points lie from the true surface (Gomez Rodriguez et al., IROS 2022, section IV). The truth of
// a point is the surface point on the ray of the pixel where it was observed: z is the depth map interpolated
// bilinearly at that pixel (never at a rounded one, which costs half a pixel times the slope), and no truth is taken
// across a depth step or next to a hole. What is left out is counted by reason. A track that slides over the surface
// has no surface error; its material error (material_error.h) shows it.
#pragma once

#include <span>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pliant/camera/camera.h"
#include "pliant/evaluation/point_error.h"

namespace pliant {

// Pairs the points of one frame with the truth, for ComputePointError. `points_in_cam` and `pixels` have one length;
// `depth_mm` is CV_32FC1, z along the optical axis, 0 = none.
PairedFrame PairWithSurface(int frame_idx, std::span<const Eigen::Vector3d> points_in_cam,
                            std::span<const Eigen::Vector2d> pixels, const Camera& camera, const cv::Mat& depth_mm,
                            double max_depth_step);

}  // namespace pliant
