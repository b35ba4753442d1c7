// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A first map, as an initializer made it: what becomes of the reports of the frames since the reference, which waited
// for it, and the landmarks with which the tracker goes on.
#pragma once

#include <vector>

#include "pliant/camera/camera.h"
#include "pliant/scene/frame_report.h"
#include "pliant/scene/map.h"
#include "pliant/tracking/bootstrapping/initializer.h"

namespace pliant {

struct FirstMap {
  std::vector<InitFrame> frames;  // since the reference: what the initializer was given
  InitOutcome outcome;            // what it answered, a map
};

// The reports since the reference, in order of time, completed: state tracking, pose, observations; a point is new in
// the first frame that shows it, colored as there. The notes of all but the last say that the map came later. A report
// that is of none of the map's frames, which was passed over, becomes lost; those before the reference stay.
std::vector<FrameReport> CompletedReports(const Camera& camera, const FirstMap& first,
                                          std::vector<FrameReport> reports);

// The points that are seen in the last frame, as they are there: at rest in the reference frame, with the motion since
// the frame before.
Map MakeFirstMap(const FirstMap& first);

}  // namespace pliant
