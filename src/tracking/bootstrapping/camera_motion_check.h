// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Before a window becomes a map: do the images show that the camera moved?
#pragma once

#include "pliant/base/status.h"
#include "pliant/tracking/bootstrapping/initializer.h"
#include "pliant/tracking/bootstrapping/make_initializer.h"
#include "tracking/bootstrapping/window_solution.h"

namespace pliant {

// (W14) kDegenerate, and `outcome` is ambiguous, where a camera that does not translate explains the frames between the
// window's views nearly as well. Fills in the outcome's still_camera_error_ratio. A rigid window is kDegenerate where
// the parallax of its points does not stand out from their errors; the outcome's median_error_px has to be filled in.
Status CheckCameraMotion(const InitInput& input, const SolvedWindow& window, const WindowInitOptions& options,
                         InitOutcome* outcome);

}  // namespace pliant
