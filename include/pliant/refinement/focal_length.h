// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The focal length of a camera from a rigid recording (docs/method.md, eq. F10): bundle adjustment with the focal
// length times factors, all with the same standard deviation of a pixel; the costs' minimum and their curvature there
// say the factor and how certain it is. Distortion and principal point are held.
#pragma once

#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/refinement/refine_recording.h"

namespace pliant {

struct FocalLengthEstimate {
  double factor = 1;     // by the camera's focal length
  double log_sigma = 0;  // standard deviation of its logarithm
};

// Up to which a focal length counts as determined.
inline constexpr double kLargestFocalLengthLogSigma = 0.05;

// `camera`: with a focal length that is right to about a factor of 1.8. Fails with kInvalidArgument as RefineRecording,
// with kInsufficient where the motion does not determine the focal length, and with kDegenerate for a recording that no
// focal length explains as rigid.
Result<FocalLengthEstimate> EstimateFocalLength(const Camera& camera, const Recording& recording,
                                                const RefineOptions& options);

}  // namespace pliant
