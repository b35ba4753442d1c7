// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Whether the images of a window show that the camera moves (docs/method.md, eq. W14).
//
// A camera that stands still before a scene that deforms gives images that a moving camera explains as well: what the
// scene does in common is then taken for a motion of the camera, and depths are wrong. So both are solved, with a scene
// as simple as possible, and compared in the images.
#pragma once

#include <vector>

#include "pliant/base/status.h"
#include "pliant/estimation/window/deforming_window.h"

namespace pliant {

// One window explained twice with the same few basis shapes, in the same views and with the same points.
struct CameraMotionModels {
  std::vector<int> point_idxs;  // of the solution they started from, ascending
  DeformingWindow moving;       // WindowCamera::kFree
  DeformingWindow still;        // WindowCamera::kRotation
};

// Basis shapes of both: with more of them a deforming scene can imitate any camera.
constexpr int kModelRank = 2;

// Both from a solution with coefficients, of the rank kModelRank or its own if that is lower: its motions, and for the
// camera that stands still also what its camera translated, as the scene's. Of the points at most 2 sample_points are
// used, spread evenly in the reference: they tell as much. `threads` never changes the result. Fails like
// SolveDeformingWindow, and with kInvalidArgument where there are no coefficients.
Result<CameraMotionModels> SolveCameraMotionModels(const DeformingSolution& solution, double focal_px,
                                                   const DeformingWindowOptions& options, int threads = 1);

// What the images say of the two.
struct CameraMotionEvidence {
  // How many times larger the reprojection errors of the camera that stands still are. About 1: camera and scene cannot
  // be told apart.
  double error_ratio = 1;
  // Whether errors as large are no accident: their mean logarithm's excess over that of the moving camera's, in
  // standard errors over the points; 0: unknown.
  double significance = 0;
  bool moving_leaves_noise = false;  // it does: its errors are no more alike than those of noise (kMaxNoiseCorrelation)
};

// Over the views in `view_idxs`; both windows have the same observations. The ratio is the geometric mean over the
// observations; errors below a fifth of the median one count as that large. Noise hides the difference: where the
// moving camera leaves noise alone and the other one does not, it is the ratio of what neighbors at `min_angle_rad` or
// more share (ErrorsOfNeighbors), if that is larger; three standard deviations of what noise shares by chance are added
// to both.
CameraMotionEvidence EvidenceOfCameraMotion(const CameraMotionModels& models, const std::vector<int>& view_idxs,
                                            double min_angle_rad);

}  // namespace pliant
