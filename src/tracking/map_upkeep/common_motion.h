// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The common motion of all points. Images do not tell a scene that moves as a whole from a camera that moves the other
// way. From frame to frame the joint problem gives such motions to the camera; what it misses adds up, and is given to
// the camera here.
#pragma once

#include "pliant/geometry/rigid3.h"
#include "pliant/scene/map.h"

namespace pliant {

// (docs/method.md, eq. E12) The part `share` of the rigid motion of the world that brings the landmarks nearest to
// where they were at rest: one step of damped least squares, for turns that are small. Points and cameras that are
// moved by it alike see the same images. None where there are fewer than three landmarks.
Rigid3 CommonMotionToRest(const Map& map, double share);

}  // namespace pliant
