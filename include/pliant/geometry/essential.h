// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The essential matrix of two calibrated views on unit rays: f1' E f0 = 0 with E = [t]x R and x1 = R x0 + t
// (cam1_from_cam0 = (R, t), the length of t does not matter). Hartley and Zisserman, "Multiple View Geometry", 9.6.
#pragma once

#include <array>
#include <span>

#include <Eigen/Core>

#include "pliant/base/status.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

// E = [t]x R.
Eigen::Matrix3d EssentialFromMotion(const Rigid3& cam1_from_cam0);

// The four motions of an essential matrix: two rotations, the smaller one first, each with +translation and
// -translation, which has unit length and an arbitrary sign.
struct EssentialMotions {
  std::array<Eigen::Quaterniond, 2> rotations;
  Eigen::Vector3d translation = Eigen::Vector3d::UnitX();
};
// Fails with kInvalidArgument when E is zero or not a number. A matrix that is not quite essential is taken as the
// nearest one.
Result<EssentialMotions> DecomposeEssential(const Eigen::Matrix3d& essential);

// The motion chosen among the four: the smaller rotation (the views are close in time), and of its two translations the
// one with more points in front of both cameras (docs/method.md, eq. I3).
struct EssentialChoice {
  Rigid3 cam1_from_cam0;  // translation of unit length
  int in_front = 0;       // points in front of both cameras with this translation
  int opposed = 0;        // and with the opposite one
};
// Fails with kInvalidArgument (see above) and with kDegenerate when the vote is a tie.
Result<EssentialChoice> ChooseMotion(const Eigen::Matrix3d& essential, std::span<const Eigen::Vector3d> rays0,
                                     std::span<const Eigen::Vector3d> rays1);

// The epipolar error of a pair of unit rays, radians, signed: to first order the least turn of both rays (root of the
// sum of squares) after which they meet (Sampson's error on the sphere; docs/method.md, eq. I1),
//   c / sqrt(|t x y|^2 + |t x f1|^2 - 2 c^2)  with  y = R f0,  c = f1 . (t x y).
// Zero when both rays point along the translation: such a pair says nothing.
double SampsonErrorRad(const Rigid3& cam1_from_cam0, const Eigen::Vector3d& ray0, const Eigen::Vector3d& ray1);

// The angle between ray1 and the epipolar plane of ray0, radians in [0, pi/2].
double EpipolarPlaneAngle(const Rigid3& cam1_from_cam0, const Eigen::Vector3d& ray0, const Eigen::Vector3d& ray1);

}  // namespace pliant
