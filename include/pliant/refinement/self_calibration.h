// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The focal length of a camera, and one coefficient of distortion, from a rigid recording (docs/method.md, eq. F10):
// bundle adjustments with the focal length times factors and with several coefficients, all with the same standard
// deviation of a pixel; the costs' minimum and their curvature there say both, and how certain they are. The principal
// point is held, and so is the distortion of a camera that has one.
#pragma once

#include <functional>
#include <optional>

#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/refinement/refine_recording.h"

namespace pliant {

struct SelfCalibration {
  Camera camera;               // the given one with the focal length found; SIMPLE_RADIAL where distortion was found
  double log_focal_sigma = 0;  // standard deviation of the logarithm of the focal length
  // Of the coefficient k; nothing: none was estimated, or it is zero to three of its standard deviations.
  std::optional<double> distortion_sigma = {};
};

// Up to which a focal length counts as determined.
inline constexpr double kLargestFocalLengthLogSigma = 0.05;

// `camera`: with a focal length that is right to about a factor of 1.8. Distortion is estimated of one without
// distortion and with one focal length. Fails with kInvalidArgument as RefineRecording, with kInsufficient where the
// motion does not determine the focal length, and with kDegenerate for a recording that no focal length explains as
// rigid. `goes_on` is asked after every iteration of every solution; false: fails with kInterrupted.
Result<SelfCalibration> SelfCalibrate(const Camera& camera, const Recording& recording, const RefineOptions& options,
                                      const std::function<bool()>& goes_on = {});

}  // namespace pliant
