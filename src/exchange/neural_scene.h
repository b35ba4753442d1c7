// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the formats for neural rendering have in common: poses in OpenGL's axes and in a unit of length that suits the
// depth images, which hold whole numbers.
#pragma once

#include <Eigen/Core>

#include "exchange/run_source.h"
#include "pliant/base/status.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

// The columns are the camera's axes to the right, up and backwards and its center, in the world, whose axes stay the
// run's. Lengths are divided by `unit`.
Eigen::Matrix<double, 3, 4> OpenGlWorldFromCam(const Rigid3& cam_from_world, double unit);

// The depths of points in the camera, those in front of it.
std::vector<double> DepthsOf(const Rigid3& cam_from_world, const std::vector<PointObservation>& observations);

// Median over the source's frames of the median depth of their points, map units. Fails with kInsufficient where no
// point lies in front of its camera, or as the reading of observations does.
Result<double> TypicalDepth(const RunSource& source);

// The largest power of ten that is not above `length` > 0.
double PowerOfTenUpTo(double length);

}  // namespace pliant
