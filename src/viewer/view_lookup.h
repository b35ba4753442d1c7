// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What pictures ask of a view.
#pragma once

#include "pliant/viewer/view.h"

namespace pliant {

// Height by width of the view's images.
double AspectOf(const View& view);

// Whether there is truth to draw: the camera's true path, or the true surface at a point.
bool HasTruth(const View& view);

// The frame of a run by its number, or null.
const ViewedFrame* FindFrame(const ViewedRun& run, int frame_idx);

}  // namespace pliant
