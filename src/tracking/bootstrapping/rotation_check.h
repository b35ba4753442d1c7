// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Before a first map is attempted: points that are all lost, and a camera that only turned, or stood still in a still
// scene, leave nothing to triangulate.
#pragma once

#include "pliant/base/status.h"
#include "pliant/estimation/two_view/two_view_models.h"
#include "pliant/tracking/bootstrapping/initializer.h"
#include "tracking/bootstrapping/initial_map.h"

namespace pliant {

// kInsufficient where no point is left in the last frame, or the sequence ends with the reference.
Status CheckIsFollowed(const InitInput& input);

// The rotation that explains most; kDegenerate when it explains more than `max_share` of the points to `max_error_px`,
// which leaves nothing to triangulate. Fills in the share measured.
Result<RotationFit> CheckNotARotation(const MatchedRays& matched, double focal_px, double max_error_px,
                                      double max_share, InitMeasurements* measured);

// kDegenerate where the camera only turned between the first frame and the last.
Status CheckWindowNotARotation(const InitInput& input, InitMeasurements* measured);

}  // namespace pliant
