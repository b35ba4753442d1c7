// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Before a deforming window becomes a map: do the images show that the camera moved?
#pragma once

#include "pliant/base/status.h"
#include "pliant/tracking/bootstrapping/initializer.h"
#include "pliant/tracking/bootstrapping/make_initializer.h"
#include "tracking/bootstrapping/window_solution.h"

namespace pliant {

// (W14) kDegenerate, and `outcome` is ambiguous, where a camera that does not translate explains the frames between the
// window's views nearly as well. A rigid window passes. Fills in the outcome's still_camera_error_ratio.
Status CheckCameraMotion(const InitInput& input, const SolvedWindow& window, const WindowInitOptions& options,
                         InitOutcome* outcome);

}  // namespace pliant
