// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the tracker makes of an initializer's map: the reports of the frames since the reference, which waited for it,
// and the landmarks that it goes on with. `frames` is what the initializer was given, `outcome` what it answered.
#pragma once

#include <span>
#include <vector>

#include "pliant/camera/camera.h"
#include "pliant/scene/frame_report.h"
#include "pliant/scene/map.h"
#include "pliant/tracking/initializer.h"

namespace pliant {

// Completes the reports since the reference, in order of time: state tracking, pose, observations; a point is new in
// the first frame that shows it, colored as there. The notes say that the map came later. A report that is of none of
// the frames, which was passed over, becomes lost.
void ReportFirstMap(const Camera& camera, const std::vector<InitFrame>& frames, const InitOutcome& outcome,
                    std::span<FrameReport> reports);

// The points that are seen in the last frame, as they are there: at rest in the reference frame, with the motion since
// the frame before.
Map MakeFirstMap(const std::vector<InitFrame>& frames, const InitOutcome& outcome);

}  // namespace pliant
