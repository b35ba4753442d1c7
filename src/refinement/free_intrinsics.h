// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A rigid bundle adjustment whose camera is solved for, too (docs/method.md, eq. F10).
#pragma once

#include <functional>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/refinement/refine_recording.h"
#include "refinement/bundle.h"

namespace pliant {

// u = f (1 + k r^2) x + c, r^2 = x^2 + y^2, for rays (x, y, 1): COLMAP's SIMPLE_RADIAL.
struct RadialIntrinsics {
  double focal_px = 0;
  double cx = 0, cy = 0;  // px, held
  double k = 0;
};

// Solves for the focal length, k, all poses but the first and all points, from `state` and `intrinsics`, with the
// robust loss of a refinement for `noise_px`. `goes_on` is asked after every iteration; false ends it. Fails with
// kDegenerate where there is no usable step.
Status SolveFreeIntrinsics(const Recording& recording, const std::vector<bool>& used, double noise_px,
                           const std::function<bool()>& goes_on, RadialIntrinsics* intrinsics, BundleState* state);

}  // namespace pliant
