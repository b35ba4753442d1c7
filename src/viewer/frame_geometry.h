// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What a camera is drawn from: its frustum, up to the plane of its image.
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "pliant/camera/camera.h"
#include "pliant/viewer/view.h"

namespace pliant {

// The rays of the image's corners, z = 1, from the top left one clockwise; where the lens has no ray in the corner (a
// disc), one farther in. Nothing where it has none at all.
std::optional<std::array<Eigen::Vector3d, 4>> CornerRays(const Camera& camera);

// Of the points before the camera; nothing where there is none.
std::optional<double> MedianDepth(const ViewedFrame& frame);

// Where the corners of a run's image are drawn, camera frame, in the order of CornerRays: a small share of the points'
// median depth away from the camera's center, whatever its field of view. Nothing where the camera is not known, or has
// no corners.
std::optional<std::array<Eigen::Vector3d, 4>> FrustumOf(const ViewedRun& run);

}  // namespace pliant
